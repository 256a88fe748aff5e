within Mechanical.Translational;
model SmoothSupportFriction "Dry friction of a slider against the housing, smooth through zero speed: creeps under load"
  extends Bases.Guide;
  parameter SI.Velocity v_c(min = 1e-9) = v_s/10 "Speed over which the Coulomb friction changes sign";
protected
  constant Real e_2 = sqrt(2*Modelica.Constants.e);
  Real x(unit = "1") "Speed over the Stribeck speed";
equation
  assert(v_c > 0, "v_c must be positive");
  x = v/v_s;
  f = e_2*(f_s - f_c)*exp(-x*x)*x + f_c*Smooth.sgn(v, v_c) + d*v;
  annotation(Documentation(info = "<html><p><code>sqrt(2 e)(f_s - f_c) exp(-x^2) x + f_c tanh(v/v_c) + d v</code>. A load below the Coulomb force moves it with <code>v_c atanh(load/f_c)</code>. Choose <code>v_c</code> such that inertia times <code>v_c/f_c</code> stays at some milliseconds. Source: form of the translational friction in MathWorks' Simscape documentation.</p></html>"));
end SmoothSupportFriction;
