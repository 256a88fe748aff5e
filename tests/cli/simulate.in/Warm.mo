model Warm "Temperatures, a difference, and one of which nobody says which it is"
  parameter Modelica.Units.SI.Temperature T = 293.15;
  parameter Modelica.Units.SI.TemperatureDifference dT = 0;
  parameter Real u(unit = "K") = 0;
  Real y(unit = "K") = T + dT + u;
end Warm;
