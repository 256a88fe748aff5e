within Mechanical.Rotational.Bases;
model Bristles "Share of a dry friction torque that acts: smooth over the speed, or by bristles that stick"
  input SI.AngularVelocity w "Speed";
  input SI.Torque hold "Greatest dry friction at that speed";
  parameter Boolean sticking = false "true: by bristles, which hold; false: tanh(w/w_s)" annotation(Evaluate = true);
  parameter SI.AngularVelocity w_s(min = 1e-9) = 1 "Width of the smooth sign of the speed";
  parameter SI.Torque hold_0(min = 1e-12) = 1 "Usual dry friction, for the stiffness of the bristles";
  parameter SI.Angle phi_s(min = 1e-9) = 5e-4 "Angle by which the bristles give at hold_0";
  parameter SI.Time tau_d(min = 0) = 2e-3 "Damping of the bristles over their stiffness, at rest";
  parameter SI.Time tau_r(min = 1e-9) = 1e-3 "Time in which bristles slip that hold more than they can";
  Real s(unit = "1") "Friction torque over hold";
  SI.Angle z(start = 0, fixed = sticking, nominal = 1e-4) "Deflection of the bristles";
protected
  parameter SI.RotationalSpringConstant sigma_0 = hold_0/phi_s "Stiffness of the bristles";
  parameter SI.RotationalDampingConstant sigma_1 = sigma_0*tau_d "Damping of the bristles at rest";
  SI.Torque g "hold, kept from 0";
  SI.AngularVelocity z_w "Rate of the deflection by the speed";
equation
  assert(hold_0 > 0 and phi_s > 0, "The usual friction hold_0 and the angle phi_s must be positive");
  g = noEvent(max(hold, 1e-3*hold_0));
  if sticking then
    z_w = w - noEvent(abs(w))*sigma_0*z/g;
    der(z) = z_w - noEvent(max(sigma_0*z - g, 0) + min(sigma_0*z + g, 0))/(sigma_0*tau_r);
    s = (sigma_0*z + sigma_1*exp(-(sigma_1*w/(4*g))^2)*z_w)/g;
  else
    z_w = 0;
    z = 0;
    s = Smooth.sgn(w, w_s);
  end if;
  annotation(Documentation(info = "<html>
<p>For machines whose dry friction varies with pressure: who uses it gives <code>w</code> and <code>hold</code>, and its torque is <code>hold s</code>. Bristles: <code>dz/dt = w - |w| sigma_0 z/hold</code>, <code>hold s = sigma_0 z + sigma_1 exp(-(sigma_1 w/(4 hold))^2) dz/dt</code>. Under a steady load below <code>hold</code> the shaft turns by <code>load/sigma_0</code> at most, <code>phi_s</code> at <code>hold_0</code>, and then stands, without creep; it breaks away at <code>hold</code>. Where <code>hold</code> falls below what the bristles carry, they slip within <code>tau_r</code>.</p>
<p>No events: any number of them, and one contact that sticks by events (<code>BearingFriction</code>), may share a rigid body; together they hold the sum. Passive for any course of <code>hold</code> above its floor of a thousandth of <code>hold_0</code>: the energy of the bristles is <code>sigma_0 z^2/2</code>, and the damping, which fades with the speed, stays below <code>4 hold/|w|</code>.</p>
<p>Source: C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, IEEE Trans. Automat. Contr. 40 (1995) 419; bound of the damping: N. Barabanov and R. Ortega, IEEE Trans. Automat. Contr. 45 (2000) 675. The slip of overloaded bristles, angle and times are assumed.</p></html>"));
end Bristles;
