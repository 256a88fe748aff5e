within Mechanical.Rotational;
model BearingFriction "Dry friction of a shaft against the housing, with sticking"
  extends Bases.DryFriction;
  Interfaces.RotationalFlange flange_a "Left flange";
  Interfaces.RotationalFlange flange_b "Right flange, moves with the left one";
  parameter SI.Torque tau_c(min = 0, nominal = 1) = 1 "Coulomb torque";
  parameter SI.Torque tau_s(min = 0, nominal = 1) = tau_c "Torque of sliding at vanishing speed, at least the Coulomb torque";
  parameter SI.AngularVelocity w_s(min = 1e-9, nominal = 1) = 1 "Stribeck speed";
  parameter Real delta(unit = "1", min = 1, max = 4) = 2 "Exponent of the Stribeck curve: 2 Gauss, 1 Tustin";
  parameter SI.RotationalDampingConstant d(min = 0, nominal = 1) = 0 "Viscous friction";
  parameter Real peak(unit = "1", min = 1, max = 10) = 1 "Holding torque over tau_s";
  SI.Angle phi "Angle";
  SI.AngularVelocity w(start = 0, nominal = 10) "Angular velocity";
  SI.AngularAcceleration a "Angular acceleration";
  SI.Torque tau "Friction torque";
  SI.Power lossPower "Power lost";
equation
  assert(tau_c >= 0 and tau_s >= tau_c, "tau_c must not be negative and tau_s not below it");
  assert(w_s > 0 and peak >= 1 and d >= 0, "w_s must be positive, peak at least 1, d not negative");
  flange_a.phi = phi;
  flange_b.phi = phi;
  w = der(phi);
  a = der(w);
  w_slide = w;
  a_slide = a;
  free = false;
  tau_0 = tau_s;
  tau_hold = peak*tau_s;
  tau_dry = tau_c + (tau_s - tau_c)*exp(-(noEvent(abs(w))/w_s)^delta);
  tau_visc = d*w;
  tau = tau_fric;
  flange_a.tau + flange_b.tau - tau = 0;
  lossPower = tau*w;
  annotation(Documentation(info = "<html>
<p>The law of <code>Friction</code> between a shaft and the housing.</p></html>"));
end BearingFriction;
