within Mechanical.Translational;
model Rope "Elastic, damped rope or chain between two flanges: only pulls"
  extends Bases.Compliant;
  parameter SI.TranslationalSpringConstant c(min = 1e-3, max = 1e12, nominal = 1e6) = 1e6 "Stiffness";
  parameter SI.TranslationalDampingConstant d(min = 0, max = 1e10, nominal = 1e3) = 1e3 "Damping";
  parameter SI.Length l(min = 0, max = 1e5, nominal = 1) = 0 "Distance of the flanges at which the rope becomes tight";
  parameter SI.Distance x_0(min = 1e-9, max = 1, nominal = 1e-4) = 1e-4 "Stretch over which the rope tightens smoothly";
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the losses";
  SI.Distance x(nominal = 1e-3) "Stretch; negative where the rope is slack";
  SI.Velocity v_rel(nominal = 0.1) "Relative speed";
  SI.Power lossPower(nominal = 10) "Power lost";
protected
  SI.Position stretch(nominal = 1e-3) "Stretch, 0 where the rope is slack";
  Real tight(unit = "1") "0 slack, 1 tight";
  SI.Force f_e(nominal = 100) "Pull of spring and damper";
equation
  assert(c > 0 and d >= 0, "The stiffness c must be positive, the damping d not negative");
  x = s_rel - l;
  v_rel = der(s_rel);
  stretch = noEvent(max(x, 0));
  tight = Smooth.step(x/x_0);
  f_e = noEvent(max(c*stretch + d*v_rel, 0));
  f = tight*f_e;
  lossPower = tight*(f_e - c*stretch)*v_rel;
  annotation(Documentation(info = "<html><p><code>f = S(x/x_0) max(0, c x + d v)</code> with the stretch x; S rises smoothly from 0 at x = 0 to 1 at <code>x_0</code>, so that the damping sets in without a jump. Slack, the rope carries nothing; it never pushes. It takes or stores energy, nowhere gives. Stiffness of a rope: <code>E A/l</code>, with E of some 1e11 Pa for wire ropes on their metallic area. No mass, no sag. <code>x_0</code> should lie well under the stretch under load.</p>
<p>Source: K. Feyrer, Wire Ropes, 2015, section 2.4 (modulus of elasticity).</p></html>"));
end Rope;
