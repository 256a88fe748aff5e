within Effects;
model RotationalStribeckFrictionBetween "Coulomb friction and a rise towards zero speed"
  extends Interfaces.RotationalBridge;
  parameter SI.Torque tau_c(min = 0, nominal = 0.1) = 0 "Coulomb friction";
  parameter SI.Torque tau_s(min = 0, nominal = 0.05) = 0 "Rise at zero speed";
  parameter SI.AngularVelocity v_c(min = 1e-9) = 0.5 "Speed over which it changes sign";
  parameter SI.AngularVelocity v_s(min = 1e-9) = 10 "Speed over which the rise falls";
equation
  tau = (tau_c + tau_s*exp(-(w_rel/v_s)^2))*tanh(w_rel/v_c);
  annotation(__bramah(family = "dry_friction", law = "dry friction", id = "E27", coefficients = {"tau_c", "tau_s"}, shapes(v_c = {0.5}, v_s = {2, 10, 50}), ends = "free"));
end RotationalStribeckFrictionBetween;
