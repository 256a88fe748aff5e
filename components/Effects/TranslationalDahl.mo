within Effects;
model TranslationalDahl "Friction with a hysteresis before it slides (Dahl)"
  extends Interfaces.TranslationalShunt;
  parameter SI.Force F_c(min = 0, nominal = 100) = 0 "Friction when it slides";
  parameter SI.Length b(min = 1e-12) = 1e-4 "Way until it slides";
  parameter SI.Velocity v_c(min = 1e-9) = 0.003 "Width of the corner";
  Real x(unit = "1", start = 0, fixed = true) "Share of the friction reached";
equation
  b*der(x) = v - Smooth.mag(v, v_c)*x;
  f = F_c*x;
  annotation(__bramah(family = "hysteresis", law = "dry friction", id = "E27", coefficients = {"F_c"}, shapes(b = {3e-5, 3e-4, 3e-3}, v_c = {0.003})));
end TranslationalDahl;
