within CascadedTanks;
block CurvedSensor "Level sensor whose characteristic is a parabola"
  Interfaces.RealInput u(unit = "m", nominal = 0.5) "Level";
  Interfaces.RealOutput y(unit = "V", nominal = 5) "What the sensor gives";
  parameter SI.Height h_m(min = 0, nominal = 0.5) = 0.5 "Level in the middle of the range";
  parameter SI.Voltage y_m(min = 0, nominal = 5) = 5 "What the sensor gives there";
  parameter Real k(unit = "V/m", min = 0, nominal = 10) = 10 "Slope there";
  parameter Real c(unit = "V/m2", min = -100, max = 100, nominal = 10) = 0 "Curvature: half the change of the slope over the level";
equation
  y = y_m + k*(u - h_m) + c*(u - h_m)^2;
  annotation(Documentation(info = "<html><p><code>y = y_m + k (u - h_m) + c (u - h_m)^2</code>.</p></html>"));
end CurvedSensor;
