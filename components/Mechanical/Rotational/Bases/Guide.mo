within Mechanical.Rotational.Bases;
partial model Guide "Friction of a shaft against the housing: ports and parameters common to all its laws"
  Interfaces.RotationalFlange flange_a "Left flange";
  Interfaces.RotationalFlange flange_b "Right flange, moves with the left one";
  parameter SI.Torque tau_c(min = 0, nominal = 1) = 1 "Coulomb torque";
  parameter SI.Torque tau_s(min = 0, nominal = 1) = tau_c "Torque of sliding at vanishing speed, at least the Coulomb torque";
  parameter SI.AngularVelocity w_s(min = 1e-6, nominal = 1) = 1 "Stribeck speed";
  parameter SI.RotationalDampingConstant d(min = 0, nominal = 1) = 0 "Viscous friction";
  SI.Angle phi(start = 0) "Angle";
  SI.AngularVelocity w(start = 0, nominal = 10) "Angular velocity";
  SI.Torque tau "Friction torque";
  SI.Power lossPower "Power lost";
equation
  assert(tau_c >= 0 and tau_s >= tau_c, "tau_c must not be negative and tau_s not below it");
  assert(w_s > 0 and d >= 0, "w_s must be positive, d not negative");
  flange_a.phi = phi;
  flange_b.phi = phi;
  w = der(phi);
  flange_a.tau + flange_b.tau - tau = 0;
  lossPower = tau*w;
end Guide;
