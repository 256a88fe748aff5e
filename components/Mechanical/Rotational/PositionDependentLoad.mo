within Mechanical.Rotational;
model PositionDependentLoad "Load over angle, given by a table"
  Interfaces.RotationalFlange flange "Flange";
  parameter Real table[:, 2] = [-1, -1; 1, 1] "Angle in rad, torque against the positive direction in N.m";
equation
  flange.tau = Signal.Functions.interpolate(table, flange.phi);
  annotation(Documentation(info = "<html><p>Straight lines through the points of the table: a cam, a weight on a lever, a press tool. Keeps energy.</p></html>"));
end PositionDependentLoad;
