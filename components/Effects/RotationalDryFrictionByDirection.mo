within Effects;
model RotationalDryFrictionByDirection "Coulomb friction of another size in each direction"
  extends Interfaces.RotationalShunt;
  parameter SI.Torque tau_p(min = 0, nominal = 0.1) = 0 "Coulomb friction at positive speed";
  parameter SI.Torque tau_n(min = 0, nominal = 0.1) = 0 "Coulomb friction at negative speed";
  parameter SI.AngularVelocity v_c(min = 1e-9) = 0.5 "Speed over which it changes sign";
equation
  tau = (0.5*(tau_p + tau_n) + 0.5*(tau_p - tau_n)*tanh(w/v_c))*tanh(w/v_c);
  annotation(__bramah(family = "dry_friction", law = "dry friction", id = "E27", coefficients = {"tau_p", "tau_n"}, shapes(v_c = {0.5})));
end RotationalDryFrictionByDirection;
