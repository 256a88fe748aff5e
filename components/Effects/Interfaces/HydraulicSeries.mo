within Effects.Interfaces;
partial model HydraulicSeries "Pressure lost where a connection is cut"
  input SI.VolumeFlowRate q(stateSelect = StateSelect.avoid, nominal = 1e-4) "Flow through it";
  output SI.Pressure dp(nominal = 1e6) "Pressure lost in the direction of q";
  annotation(__bramah(attach = "Series", drop = "dp", through = "q"));
end HydraulicSeries;
