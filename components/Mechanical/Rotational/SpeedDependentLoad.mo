within Mechanical.Rotational;
model SpeedDependentLoad "Load over speed, given by a table"
  Interfaces.RotationalFlange flange "Flange";
  parameter Real table[:, 2] = [-1, -1; 1, 1] "Speed in rad/s, torque against the motion in N.m";
  SI.AngularVelocity w(nominal = 10) "Speed";
equation
  w = der(flange.phi);
  flange.tau = Signal.Functions.interpolate(table, w);
  annotation(Documentation(info = "<html><p>Straight lines through the points of the table; positive values act against the motion at positive speed.</p></html>"));
end SpeedDependentLoad;
