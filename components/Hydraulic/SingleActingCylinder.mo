within Hydraulic;
model SingleActingCylinder "Single-acting cylinder: pressure extends, spring and load retract"
  Interfaces.HydraulicPort port "Chamber";
  Interfaces.TranslationalFlange flange "Rod";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.Area A(min = 1e-8, max = 10, nominal = 1e-3, displayUnit = "cm2") = 1e-3 "Area of the piston";
  parameter SI.Length stroke(min = 1e-4, max = 100, nominal = 0.1) = 0.2 "Stroke";
  parameter SI.Volume V_0(min = 1e-9, nominal = 1e-4, displayUnit = "ml") = 1e-4 "Volume at s = 0";
  parameter SI.Mass m(min = 1e-6, max = 1e6, nominal = 10) = 5 "Mass of piston and rod";
  parameter SI.TranslationalSpringConstant c(min = 1e-6) = 1e3 "Return spring";
  parameter SI.Force F_0(min = 0) = 200 "Force of the return spring at s = 0";
  parameter SI.Pressure p_ambient(nominal = 1e5) = 101325 "Pressure outside";
  parameter SI.Pressure p_rated(min = 1e4, max = 1e10, nominal = 1e7) = oil.p_max "Pressure that the end stops are made for";
  parameter SI.Position s_start = 0.01 "Position at the start";
  parameter SI.Pressure p_start(nominal = 1e6) = 101325 "Pressure at the start";
  replaceable model Air = EntrainedAir.Frozen constrainedby EntrainedAir.Law "What becomes of the air in the oil";
  Chamber chamber(redeclare model Air = Air, A = A, side = 1, V_0 = V_0, p_ambient = p_ambient, p_start = p_start) "Chamber";
  Mechanical.Translational.Mass piston(m = m, s(start = s_start)) "Piston and rod";
  Mechanical.Translational.EndStops stops(s_min = 0, s_max = stroke, k = max(1e8, A*p_rated/d_stop), d_0 = min(1e-4, d_stop)) "End stops";
  Mechanical.Translational.Spring spring(c = c, s_rel0 = -F_0/c) "Return spring";
  Mechanical.Translational.Fixed housing "Housing";
  replaceable SealFriction.Stribeck seal constrainedby SealFriction.Law "Friction of the seal";
protected
  parameter SI.Length d_stop = max(min(1e-3*stroke, V_0/A/2), 1e-5) "Depth in an end stop at p_rated";
equation
  assert(stroke > 0 and c > 0, "The stroke and the spring c must be positive");
  assert(s_start > -0.01*stroke and s_start < 1.01*stroke, "The position at the start s_start must lie from 0 to the stroke");
  connect(port, chamber.port);
  connect(chamber.flange, piston.flange_a);
  connect(seal.flange, piston.flange_a);
  connect(stops.flange, piston.flange_a);
  connect(housing.flange, spring.flange_a);
  connect(spring.flange_b, piston.flange_a);
  connect(piston.flange_b, flange);
  seal.p_1 = chamber.p - p_ambient;
  seal.p_2 = 0;
  annotation(Documentation(info = "<html><p><code>m dv/dt = A (p - p_a) - F_0 - c s - f_seal</code>, end stops at both ends, as stiff as in <code>Cylinder</code> (<code>p_rated</code>); friction replaceable as in <code>Cylinder</code>. Rod side open to the surroundings. Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 6.1.</p></html>"));
end SingleActingCylinder;
