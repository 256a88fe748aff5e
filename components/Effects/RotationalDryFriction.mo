within Effects;
model RotationalDryFriction "Coulomb friction, smooth through zero speed"
  extends Interfaces.RotationalShunt;
  parameter SI.Torque tau_c(min = 0, nominal = 0.1) = 0 "Coulomb friction";
  parameter SI.AngularVelocity v_c(min = 1e-9) = 0.5 "Speed over which it changes sign";
equation
  tau = tau_c*tanh(w/v_c);
  annotation(__bramah(family = "dry_friction", law = "dry friction", id = "E02", coefficients = {"tau_c"}, shapes(v_c = {0.5})));
end RotationalDryFriction;
