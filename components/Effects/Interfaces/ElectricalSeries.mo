within Effects.Interfaces;
partial model ElectricalSeries "Voltage lost where a connection is cut"
  input SI.Current i(stateSelect = StateSelect.avoid) "Current through it";
  output SI.Voltage v "Voltage lost in the direction of i";
  annotation(__bramah(attach = "Series", drop = "v", through = "i"));
end ElectricalSeries;
