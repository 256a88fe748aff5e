within Effects;
model RodBacklash "Play in a connection: the first side moves against the second within the gap"
  extends Interfaces.TranslationalSeries;
  parameter SI.Length b(min = 0, nominal = 1e-3) = 0 "Width of the gap";
  parameter SI.Force F_s(min = 1e-9) = 20 "Load that closes it";
equation
  s_rel = 0.5*b*tanh(f/F_s);
  annotation(__bramah(family = "backlash", id = "E37", coefficients = {"b"}, shapes(F_s = {20})));
end RodBacklash;
