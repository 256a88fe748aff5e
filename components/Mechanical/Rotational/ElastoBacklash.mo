within Mechanical.Rotational;
model ElastoBacklash "Backlash with elastic, damped contact on both sides"
  extends Bases.Compliant;
  parameter SI.Angle b(min = 0, nominal = 1e-3) = 1e-3 "Total play";
  parameter SI.RotationalSpringConstant c(min = 0, max = 1e12, nominal = 1e4) = 1e4 "Stiffness of the contact";
  parameter SI.RotationalDampingConstant d(min = 0, max = 1e10, nominal = 1) = 1 "Damping of the contact";
  parameter SI.Angle phi_rel0 = 0 "Relative angle in the middle of the play";
  SI.AngularVelocity w_rel(nominal = 10) "Relative speed";
protected
  SI.Angle x "Angle from the middle of the play";
equation
  assert(b >= 0, "The play b must not be negative");
  assert(c > 0 and d >= 0, "The stiffness c must be positive, the damping d not negative");
  x = phi_rel - phi_rel0;
  w_rel = der(phi_rel);
  tau = if x > b/2 then smooth(0, noEvent(max(0, c*(x - b/2) + d*w_rel)))
    elseif x < -b/2 then smooth(0, noEvent(min(0, c*(x + b/2) + d*w_rel)))
    else 0;
  annotation(Documentation(info = "<html><p>Touching is an event. The contact does not pull: while the flanks part, the damping never exceeds the spring. The damping sets in with a jump at impact.</p></html>"));
end ElastoBacklash;
