within Effects.Interfaces;
partial model RotationalSeries "Elastic element where a connection is cut"
  input SI.Torque tau(stateSelect = StateSelect.avoid) "Torque through it";
  output SI.Angle phi_rel "Angle of the first side relative to the second";
  annotation(__bramah(attach = "Series", drop = "phi_rel", through = "tau"));
end RotationalSeries;
