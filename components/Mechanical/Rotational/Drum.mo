within Mechanical.Rotational;
model Drum "Rope drum whose radius grows with the layers of rope, without loss"
  Interfaces.RotationalFlange flangeR "Shaft, winds the rope up when it turns forward";
  Interfaces.TranslationalFlange flangeT "Rope where it leaves the drum; positive away from the drum";
  parameter SI.Radius r(min = 1e-3, max = 100, nominal = 0.2) = 0.2 "Radius of the bare drum";
  parameter SI.Diameter d_rope(min = 1e-4, max = 1, nominal = 0.01) = 0.01 "Diameter of the rope";
  parameter Real h(unit = "1", min = 0.1, max = 1) = 0.866 "Height of a layer over the diameter of the rope: 0.866 where ropes lie in the grooves of the layer below, 1 where on top of each other";
  parameter Real n(unit = "1", min = 1, max = 1e4, nominal = 20) = 20 "Turns in a layer";
  parameter Integer layers(min = 1, max = 50) = 4 "Layers of a full drum";
  parameter Real turns_start(unit = "1", min = 0, max = 5e5) = 10 "Turns on the drum where the angle is 0";
  parameter Real x_0(unit = "1", min = 1e-3, max = 1) = 0.5 "Turns over which the rope climbs to the next layer";
  parameter SI.Position s_0 = 0 "Position of flangeT where the angle is 0";
  Real turns(unit = "1", nominal = 10) "Turns on the drum";
  SI.Radius r_eff(nominal = 0.2) "Radius of the middle of the rope";
  SI.Length l(nominal = 10) "Length of rope on the drum";
protected
  parameter SI.Radius r_1 = r + d_rope/2 "Radius of the middle of the rope in the first layer";
  parameter SI.Length l_start = 2*Modelica.Constants.pi*(r_1*turns_start + h*d_rope*sum(Smooth.ramp(turns_start - j*n, x_0) for j in 1:layers - 1)) "Length on the drum where the angle is 0";
equation
  assert(r > 0 and d_rope > 0, "The radius r of the drum and the diameter d_rope of the rope must be positive");
  assert(n >= x_0, "A layer must hold more turns than the rope needs to climb");
  assert(turns_start >= 0 and turns_start <= n*layers, "At the start there must be between 0 and n*layers turns on the drum");
  assert(turns >= 0, "The rope has run off the drum: no turn is left on it");
  assert(turns <= n*layers, "The drum is full: all its layers are wound");
  turns = turns_start + flangeR.phi/(2*Modelica.Constants.pi);
  l = 2*Modelica.Constants.pi*(r_1*turns + h*d_rope*sum(Smooth.ramp(turns - j*n, x_0) for j in 1:layers - 1));
  r_eff = r_1 + h*d_rope*sum(noEvent(min(max((turns - j*n)/x_0, 0), 1)) for j in 1:layers - 1);
  flangeT.s = s_0 - (l - l_start);
  flangeR.tau = r_eff*flangeT.f;
  annotation(Documentation(info = "<html><p>Layer j lies at the radius <code>r + d_rope/2 + (j - 1) h d_rope</code>; from one layer to the next the radius rises along <code>x_0</code> turns. The length on the drum is the integral of the radius over the angle, so that no power is lost: <code>ds/dt = -r_eff w</code>, <code>tau = r_eff f</code>. A full or an empty drum stops the run with an error. The drum has no inertia: join <code>Inertia</code>. The rope itself, which only pulls: <code>Translational.Rope</code>, both together: <code>Winch</code>.</p>
<p>Source: K. Feyrer, Wire Ropes, 2015, chapter 3 (drums with several layers).</p></html>"));
end Drum;
