within Effects;
model RodBacklash "Play in a connection: the first side moves against the second within the gap"
  extends Interfaces.TranslationalSeries;
  parameter SI.Length b(min = 0, nominal = 1e-3) = 0 "Width of the gap";
  parameter SI.Force F_min(nominal = 100) = 0 "Least force that occurs";
  parameter SI.Force F_max(nominal = 100) = 1 "Greatest force that occurs";
  parameter Real w(unit = "1", min = 1e-6) = 0.01 "Load that closes the gap over half the range of the force";
  SI.Force F_s(nominal = 1) "Load that closes it";
equation
  F_s = 0.5*w*(F_max - F_min);
  // no tanh: under load it would be flat to the last digit, and no force would follow from the gap
  s_rel = 0.5*b*f/sqrt(f^2 + F_s^2);
  annotation(__bramah(family = "backlash", id = "E37", coefficients = {"b"}, shapes(w = {0.01}), range = {"f", "F_min", "F_max"}));
end RodBacklash;
