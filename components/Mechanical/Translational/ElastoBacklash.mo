within Mechanical.Translational;
model ElastoBacklash "Backlash with elastic, damped contact on both sides"
  extends Bases.Compliant;
  parameter SI.Position b(min = 0, nominal = 1e-4) = 1e-4 "Total play";
  parameter SI.TranslationalSpringConstant c(min = 1e-6, max = 1e12, nominal = 1e6) = 1e6 "Stiffness of the contact";
  parameter SI.TranslationalDampingConstant d(min = 0, max = 1e10, nominal = 1e3) = 1e3 "Damping of the contact";
  parameter SI.TranslationalDampingConstant d_play(min = 0, max = 1e10, nominal = 1) = 0 "Damping within the play; needed, however small, where nothing with inertia is joined to a flange";
  parameter SI.Position s_rel0 = 0 "Relative position in the middle of the play";
  SI.Velocity v_rel(nominal = 0.1) "Relative speed";
protected
  SI.Position x "Position from the middle of the play";
equation
  assert(b >= 0, "The play b must not be negative");
  assert(c > 0 and d >= 0 and d_play >= 0, "The stiffness c must be positive, the dampings d and d_play not negative");
  x = s_rel - s_rel0;
  v_rel = der(s_rel);
  f = d_play*v_rel + (if x > b/2 then smooth(0, noEvent(max(0, c*(x - b/2) + d*v_rel)))
    elseif x < -b/2 then smooth(0, noEvent(min(0, c*(x + b/2) + d*v_rel)))
    else 0);
  annotation(Documentation(info = "<html><p>Touching is an event. The contact does not pull: while the flanks part, the damping never exceeds the spring. The damping sets in with a jump at impact.</p>
<p>Within the play nothing joins the flanges, so each needs something with inertia, which says how it moves there. A flange without (a joint between two springs, say) is moved by <code>d_play</code> instead, the drag of the oil film: a thousandth of <code>d</code> serves.</p></html>"));
end ElastoBacklash;
