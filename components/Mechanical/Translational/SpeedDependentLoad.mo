within Mechanical.Translational;
model SpeedDependentLoad "Load over speed, given by a table"
  Interfaces.TranslationalFlange flange "Flange";
  parameter Real table[:, 2] = [-1, -1; 1, 1] "Speed in m/s, force against the motion in N";
  SI.Velocity v(nominal = 0.1) "Speed";
equation
  v = der(flange.s);
  flange.f = Signal.Functions.interpolate(table, v);
  annotation(Documentation(info = "<html><p>Straight lines through the points of the table; positive values act against the motion at positive velocity.</p></html>"));
end SpeedDependentLoad;
