within Mechanical.Translational;
model PositionDependentLoad "Load over position, given by a table"
  Interfaces.TranslationalFlange flange "Flange";
  parameter Real table[:, 2] = [-1, -1; 1, 1] "Position in m, force against the positive direction in N";
equation
  flange.f = Signal.Functions.interpolate(table, flange.s);
  annotation(Documentation(info = "<html><p>Straight lines through the points of the table: a cam, a weight on a lever, a press tool. Keeps energy.</p></html>"));
end PositionDependentLoad;
