within Mechanical.Rotational;
model PositionDependentLoad "Load over angle, given by a table"
  Interfaces.RotationalFlange flange "Flange";
  parameter Real table[:, 2] = [-1, -1; 1, 1] "Angle in rad, torque against the positive direction in N.m";
equation
  flange.tau = Signal.Functions.interpolate(table, flange.phi);
end PositionDependentLoad;
