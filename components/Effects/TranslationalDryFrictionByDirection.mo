within Effects;
model TranslationalDryFrictionByDirection "Coulomb friction of another size in each direction"
  extends Interfaces.TranslationalShunt;
  parameter SI.Force F_p(min = 0, nominal = 100) = 0 "Coulomb friction at positive speed";
  parameter SI.Force F_n(min = 0, nominal = 100) = 0 "Coulomb friction at negative speed";
  parameter SI.Velocity v_c(min = 1e-9) = 0.003 "Speed over which it changes sign";
equation
  f = (0.5*(F_p + F_n) + 0.5*(F_p - F_n)*tanh(v/v_c))*tanh(v/v_c);
  annotation(__bramah(family = "dry_friction", law = "dry friction", id = "E27", coefficients = {"F_p", "F_n"}, shapes(v_c = {0.003})));
end TranslationalDryFrictionByDirection;
