within Mechanical.Translational;
model Gravity "Weight of a mass along the axis, on one flange"
  Interfaces.TranslationalFlange flange "Flange";
  parameter SI.Mass m(min = 0) = 1 "Mass whose weight acts";
  parameter SI.Angle slope = Modelica.Constants.pi/2 "Angle of the positive direction above the horizontal";
  parameter SI.Acceleration g = Modelica.Constants.g_n "Acceleration of gravity";
equation
  flange.f = m*g*sin(slope);
  annotation(Documentation(info = "<html><p><code>f = m g sin(slope)</code> along the guide.</p></html>"));
end Gravity;
