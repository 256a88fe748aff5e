within Mechanical.Rotational;
model SmoothBearingFriction "Dry friction of a shaft against the housing, smooth through zero speed: creeps under load"
  extends Bases.Guide;
  parameter SI.AngularVelocity w_c(min = 1e-9) = w_s/10 "Speed over which the Coulomb friction changes sign";
protected
  constant Real e_2 = sqrt(2*Modelica.Constants.e);
  Real x(unit = "1") "Speed over the Stribeck speed";
equation
  assert(w_c > 0, "w_c must be positive");
  x = w/w_s;
  tau = e_2*(tau_s - tau_c)*exp(-x*x)*x + tau_c*Smooth.sgn(w, w_c) + d*w;
  annotation(Documentation(info = "<html><p><code>sqrt(2 e)(tau_s - tau_c) exp(-x^2) x + tau_c tanh(v/w_c) + d v</code>. A load below the Coulomb torque moves it with <code>w_c atanh(load/tau_c)</code>. Choose <code>w_c</code> such that inertia times <code>w_c/tau_c</code> stays at some milliseconds. Source: form of the rotational friction in MathWorks' Simscape documentation.</p></html>"));
end SmoothBearingFriction;
