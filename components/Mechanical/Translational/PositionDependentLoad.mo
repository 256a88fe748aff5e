within Mechanical.Translational;
model PositionDependentLoad "Load over position, given by a table"
  Interfaces.TranslationalFlange flange "Flange";
  parameter Real table[:, 2] = [-1, -1; 1, 1] "Position in m, force against the positive direction in N";
equation
  flange.f = Signal.Functions.interpolate(table, flange.s);
end PositionDependentLoad;
