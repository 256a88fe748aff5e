within Mechanical.Rotational;
model ElastoBacklash "Backlash with elastic, damped contact on both sides"
  extends Bases.Compliant;
  parameter SI.Angle b(min = 0, nominal = 1e-3) = 1e-3 "Total play";
  parameter SI.RotationalSpringConstant c(min = 1e-6, max = 1e12, nominal = 1e4) = 1e4 "Stiffness of the contact";
  parameter SI.RotationalDampingConstant d(min = 0, max = 1e10, nominal = 1) = 1 "Damping of the contact";
  parameter SI.RotationalDampingConstant d_play(min = 0, max = 1e10, nominal = 1e-3) = 0 "Damping within the play; needed, however small, where nothing with inertia is joined to a flange";
  parameter SI.Angle phi_rel0 = 0 "Relative angle in the middle of the play";
  SI.AngularVelocity w_rel(nominal = 10) "Relative speed";
protected
  SI.Angle x "Angle from the middle of the play";
equation
  assert(b >= 0, "The play b must not be negative");
  assert(c > 0 and d >= 0 and d_play >= 0, "The stiffness c must be positive, the dampings d and d_play not negative");
  x = phi_rel - phi_rel0;
  w_rel = der(phi_rel);
  tau = d_play*w_rel + (if x > b/2 then smooth(0, noEvent(max(0, c*(x - b/2) + d*w_rel)))
    elseif x < -b/2 then smooth(0, noEvent(min(0, c*(x + b/2) + d*w_rel)))
    else 0);
  annotation(Documentation(info = "<html><p>Touching is an event. The contact does not pull: while the flanks part, the damping never exceeds the spring. The damping sets in with a jump at impact.</p>
<p>Within the play nothing joins the flanges, so each needs something with inertia, which says how it moves there. A flange without (a joint between two springs, say) is moved by <code>d_play</code> instead, the drag of the oil film: a thousandth of <code>d</code> serves.</p></html>"));
end ElastoBacklash;
