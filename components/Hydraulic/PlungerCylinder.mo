within Hydraulic;
model PlungerCylinder "Plunger cylinder: pressure extends, the load retracts"
  Interfaces.HydraulicPort port "Chamber";
  Interfaces.TranslationalFlange flange "Plunger";
  parameter SI.Diameter d(min = 1e-3, max = 3, nominal = 0.1) = 0.05 "Diameter of the plunger";
  parameter SI.Length stroke(min = 1e-4, max = 100, nominal = 0.1) = 0.3 "Stroke";
  parameter SI.Volume V_0(min = 1e-9, max = 10, nominal = 1e-4, displayUnit = "ml") = 1e-4 "Volume at s = 0";
  parameter SI.Mass m(min = 1e-6, max = 1e6, nominal = 10) = 10 "Mass of the plunger";
  parameter SI.Pressure p_ambient(min = 0, max = 1e7, nominal = 1e5) = 101325 "Pressure outside";
  parameter SI.Position s_start(min = -1, max = 100, nominal = 0.1) = 0.01 "Position at the start";
  parameter SI.Velocity v_start(min = -100, max = 100, nominal = 0.1) = 0 "Velocity at the start";
  parameter SI.Pressure p_start(min = 1e3, max = 1e8, nominal = 1e6) = 101325 "Pressure at the start";
  replaceable model Air = EntrainedAir.Frozen constrainedby EntrainedAir.Law "What becomes of the air in the oil";
  Chamber chamber(redeclare model Air = Air, A = A, side = 1, V_0 = V_0, p_ambient = p_ambient, p_start = p_start) "Chamber";
  Mechanical.Translational.Mass plunger(m = m, s(start = s_start), v(start = v_start)) "Plunger";
  Mechanical.Translational.EndStops stops(s_min = 0, s_max = stroke) "End stops";
  replaceable SealFriction.Stribeck seal constrainedby SealFriction.Law "Friction of the seal";
  SI.Position s(nominal = 0.1) "Position, 0 retracted";
  SI.Velocity v(nominal = 0.1) "Velocity";
  SI.Pressure p(nominal = 1e6) "Pressure";
protected
  parameter SI.Area A = Modelica.Constants.pi/4*d^2 "Area of the plunger";
equation
  assert(d > 0 and stroke > 0, "The diameter d and the stroke must be positive");
  assert(s_start > -0.01*stroke and s_start < 1.01*stroke, "The position at the start s_start must lie from 0 to the stroke");
  connect(port, chamber.port);
  connect(chamber.flange, plunger.flange_a);
  connect(seal.flange, plunger.flange_a);
  connect(stops.flange, plunger.flange_a);
  connect(plunger.flange_b, flange);
  seal.p_1 = chamber.p - p_ambient;
  seal.p_2 = 0;
  s = plunger.s;
  v = plunger.v;
  p = chamber.p;
  annotation(Documentation(info = "<html><p><code>m dv/dt = pi/4 d^2 (p - p_a) - f_seal + f_flange</code>: the pressure acts on the rod itself, which needs no piston and no machined bore; only the load, or a second plunger against it, brings it back. End stops at both ends; the friction is replaceable as in <code>Cylinder</code>. The mass has no weight of its own: join <code>Mechanical.Translational.Gravity</code> or a force. With a return spring: <code>SingleActingCylinder</code>. Valid as <code>Chamber</code>. Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 6.1.</p></html>"));
end PlungerCylinder;
