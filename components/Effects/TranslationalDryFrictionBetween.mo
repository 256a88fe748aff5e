within Effects;
model TranslationalDryFrictionBetween "Coulomb friction, smooth through zero speed"
  extends Interfaces.TranslationalBridge;
  parameter SI.Force F_c(min = 0, nominal = 100) = 0 "Coulomb friction";
  parameter SI.Velocity v_c(min = 1e-9) = 0.003 "Speed over which it changes sign";
equation
  f = F_c*tanh(v_rel/v_c);
  annotation(__bramah(family = "dry_friction", law = "dry friction", id = "E02", coefficients = {"F_c"}, shapes(v_c = {0.003}), ends = "free"));
end TranslationalDryFrictionBetween;
