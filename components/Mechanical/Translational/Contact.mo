within Mechanical.Translational;
model Contact "One-sided contact between two bodies: elastic, with loss, never pulls"
  extends Bases.Compliant;
  parameter SI.TranslationalSpringConstant c(min = 1e-3, max = 1e12, nominal = 1e7) = 1e7 "Force over depth at the depth d_0";
  parameter SI.Distance d_0(min = 1e-9, max = 1, nominal = 1e-4) = 1e-4 "Depth at which c holds";
  parameter Real n(unit = "1", min = 1, max = 3) = 1.5 "Exponent of the depth: 1 flat faces, 1.5 sphere";
  parameter Real alpha(unit = "s/m", min = 0, max = 100, nominal = 0.1) = 0.1 "Loss: slow impacts come back with 1 - alpha v times their speed v";
  parameter SI.Position s_rel0 = 0 "Relative position at which the bodies touch";
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the losses";
  SI.Distance gap(nominal = 1e-3) "Distance of the faces; negative where they press on each other";
  SI.Velocity v_in(nominal = 0.1) "Speed at which the bodies approach";
  SI.Force f_n(nominal = 100) "Force with which the bodies press on each other";
  SI.Power lossPower(nominal = 10) "Power lost";
protected
  SI.Force f_c(nominal = 100) "Elastic part of the force";
  Real damping(unit = "1") "Force over its elastic part";
equation
  assert(c > 0 and d_0 > 0, "The stiffness c and its depth d_0 must be positive");
  assert(alpha >= 0 and n >= 1, "The loss alpha must not be negative, the exponent n not below 1");
  gap = s_rel - s_rel0;
  v_in = -der(s_rel);
  f_c = c*d_0*noEvent(max(-gap/d_0, 0))^n;
  damping = noEvent(max(1 + 1.5*alpha*v_in, 0));
  f_n = f_c*damping;
  f = -f_n;
  lossPower = f_c*(damping - 1)*v_in;
  annotation(Documentation(info = "<html><p><code>f_n = c d_0 (depth/d_0)^n max(0, 1 + 3/2 alpha v_in)</code>: the damping grows with the depth, so that the force begins and ends at 0 and never pulls. It takes energy or stores it, nowhere gives. A body that meets at rest what it hits comes back with <code>e = 1 - alpha v</code> times its speed while <code>alpha v</code> is small; exactly, <code>u - ln(1 + u) = -e u - ln(1 - e u)</code> with <code>u = 3/2 alpha v</code>, whatever the mass, c and n. Steel on steel: alpha of 0.1 to 0.3 s/m. Body b lies on the positive side of a.</p>
<p>Source: K. H. Hunt and F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440.</p></html>"));
end Contact;
