within Effects.Shapes;
model FrictionPeriodicInPosition "Dry friction that depends on the position, again and again along the way"
  extends Interfaces.TranslationalShunt;
  parameter SI.Force F_0(min = 0, nominal = 100) = 0 "Mean friction";
  parameter SI.Force F_s(nominal = 100) = 0 "Part that goes with the sine";
  parameter SI.Force F_c(nominal = 100) = 0 "Part that goes with the cosine";
  parameter SI.Position s_min(nominal = 1e-2) = 0 "Least position that occurs";
  parameter SI.Position s_max(nominal = 1e-2) = 1 "Greatest position that occurs";
  parameter Real n(unit = "1", min = 0.5) = 4 "Periods over the way that occurs";
  parameter SI.Velocity v_c(min = 1e-9) = 0.003 "Speed over which it changes sign";
  Real a(unit = "1") "Angle within a period";
equation
  a = 6.283185307179586*n*(s - s_min)/(s_max - s_min);
  f = tanh(v/v_c)*(F_0 + F_s*sin(a) + F_c*cos(a));
  annotation(__bramah(family = "shape", coefficients = {"F_0", "F_s", "F_c"}, range = {"s", "s_min", "s_max"}, shapes(n = {2, 3, 4, 5, 6, 7, 8, 10, 12}, v_c = {0.003})));
end FrictionPeriodicInPosition;
