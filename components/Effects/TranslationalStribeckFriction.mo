within Effects;
model TranslationalStribeckFriction "Coulomb friction and a rise towards zero speed"
  extends Interfaces.TranslationalShunt;
  parameter SI.Force F_c(min = 0, nominal = 100) = 0 "Coulomb friction";
  parameter SI.Force F_s(min = 0, nominal = 50) = 0 "Rise at zero speed";
  parameter SI.Velocity v_c(min = 1e-9) = 0.003 "Speed over which it changes sign";
  parameter SI.Velocity v_s(min = 1e-9) = 0.04 "Speed over which the rise falls";
equation
  f = (F_c + F_s*exp(-(v/v_s)^2))*tanh(v/v_c);
  annotation(__bramah(family = "dry_friction", law = "dry friction", id = "E27", coefficients = {"F_c", "F_s"}, shapes(v_c = {0.003}, v_s = {0.01, 0.04, 0.15})));
end TranslationalStribeckFriction;
