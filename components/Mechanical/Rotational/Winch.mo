within Mechanical.Rotational;
model Winch "Drum with layers of rope and an elastic rope that only pulls"
  Interfaces.RotationalFlange flangeR "Shaft, winds the rope up when it turns forward";
  Interfaces.TranslationalFlange flangeT "End of the rope; positive away from the drum";
  parameter SI.Radius r(min = 1e-3, max = 100, nominal = 0.2) = 0.2 "Radius of the bare drum";
  parameter SI.Diameter d_rope(min = 1e-4, max = 1, nominal = 0.01) = 0.01 "Diameter of the rope";
  parameter Real h(unit = "1", min = 0.1, max = 1) = 0.866 "Height of a layer over the diameter of the rope";
  parameter Real n(unit = "1", min = 1, max = 1e4, nominal = 20) = 20 "Turns in a layer";
  parameter Integer layers(min = 1, max = 50) = 4 "Layers of a full drum";
  parameter Real turns_start(unit = "1", min = 0, max = 5e5) = 10 "Turns on the drum where the angle is 0";
  parameter SI.TranslationalSpringConstant c(min = 1e-3, max = 1e12, nominal = 1e6) = 1e6 "Stiffness of the free rope";
  parameter SI.TranslationalDampingConstant d(min = 0, max = 1e10, nominal = 1e3) = 1e3 "Damping of the free rope";
  parameter SI.Distance x_0(min = 1e-9, max = 1, nominal = 1e-4) = 1e-4 "Stretch over which the rope tightens smoothly";
  parameter SI.Position s_0 = 0 "Position of flangeT at which the rope becomes tight where the angle is 0";
  parameter Boolean useHeatPort = false "true: the power lost in the rope heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort if useHeatPort "Heat of the losses";
  Drum drum(final r = r, final d_rope = d_rope, final h = h, final n = n, final layers = layers, final turns_start = turns_start, final s_0 = s_0) "Drum";
  Translational.Rope rope(final c = c, final d = d, final x_0 = x_0, final useHeatPort = useHeatPort) "Rope";
  SI.Force f(nominal = 1e3) "Pull of the rope";
equation
  f = rope.f;
  connect(flangeR, drum.flangeR);
  connect(drum.flangeT, rope.flange_a);
  connect(rope.flange_b, flangeT);
  connect(rope.heatPort, heatPort);
  annotation(Documentation(info = "<html><p>See <code>Drum</code> and <code>Translational.Rope</code>. The stiffness is that of the free rope in the position of interest, <code>E A/length</code>, and does not follow the length: valid where the free length changes by less than half. The mass of the rope is left out. Where the load stands on the ground and the drum pays out, the rope is slack and carries nothing.</p></html>"));
end Winch;
