within Effects.Interfaces;
partial model HydraulicBridgeAtShaft "Volume flow between two ports of a component that also has a shaft"
  input SI.Pressure p_a(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the first port";
  input SI.Pressure p_b(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the second port";
  input SI.Angle phi(stateSelect = StateSelect.avoid) "Angle of the shaft";
  output SI.VolumeFlowRate q(nominal = 1e-4) "Flow from the first to the second port";
  SI.Pressure dp(nominal = 1e6) "Pressure difference";
  SI.AngularVelocity w(nominal = 10) "Speed of the shaft";
equation
  dp = p_a - p_b;
  w = der(phi);
  annotation(__bramah(attach = "Bridge", potential = {"p_a", "p_b"}, through = "q", sense = {"phi"}));
end HydraulicBridgeAtShaft;
