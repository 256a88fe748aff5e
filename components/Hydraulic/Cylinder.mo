within Hydraulic;
model Cylinder "Double-acting cylinder: two chambers, seal friction, leakage, end stops, mass of the piston"
  Interfaces.HydraulicPort port_1 "Chamber 1; its pressure extends the rod";
  Interfaces.HydraulicPort port_2 "Chamber 2; its pressure retracts the rod";
  Interfaces.TranslationalFlange flange "Rod";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.Area A_1(min = 1e-8, max = 10, nominal = 1e-3, displayUnit = "cm2") = 50.27e-4 "Area of chamber 1";
  parameter SI.Area A_2(min = 1e-8, max = 10, nominal = 1e-3, displayUnit = "cm2") = 37.70e-4 "Area of chamber 2";
  parameter SI.Length stroke(min = 1e-4, max = 100, nominal = 0.1) = 0.18 "Stroke";
  parameter SI.Volume V_01(min = 1e-9, nominal = 1e-4, displayUnit = "ml") = 1e-4 "Volume of chamber 1 at s = 0, fully retracted";
  parameter SI.Volume V_02(min = 1e-9, nominal = 1e-4, displayUnit = "ml") = 1e-4 "Volume of chamber 2 at s = stroke, fully extended";
  parameter SI.Mass m(min = 1e-6, max = 1e6, nominal = 10) = 10 "Mass of piston and rod";
  parameter Real C_i(unit = "m3/(s.Pa)", min = 0, max = 1e-9, nominal = 1e-13) = 1e-13 "Conductance of the piston leakage at mu_C";
  parameter Boolean rodLeakage = false "true: with leakage past the rod seal to the outside" annotation(Evaluate = true);
  parameter Real C_e(unit = "m3/(s.Pa)", min = 0, max = 1e-9, nominal = 1e-13) = 1e-14 "Conductance of the rod leakage at mu_C";
  parameter SI.DynamicViscosity mu_C(min = 1e-4, max = 10, nominal = 0.03) = 0.04 "Viscosity of C_i";
  parameter Boolean followViscosity = true "false: C_i is taken as it is" annotation(Evaluate = true);
  parameter SI.Pressure p_ambient(nominal = 1e5) = 101325 "Pressure on the rod outside";
  parameter SI.Pressure p_rated(min = 1e4, max = 1e10, nominal = 1e7) = oil.p_max "Pressure that the end stops are made for";
  parameter SI.Position s_start = 0.05 "Position at the start";
  parameter SI.Velocity v_start = 0 "Velocity at the start";
  parameter SI.Pressure p_1_start(nominal = 1e6) = 101325 "Pressure of chamber 1 at the start";
  parameter SI.Pressure p_2_start(nominal = 1e6) = 101325 "Pressure of chamber 2 at the start";
  replaceable model Air = EntrainedAir.Frozen constrainedby EntrainedAir.Law "What becomes of the air in the oil";
  Chamber chamber_1(redeclare model Air = Air, A = A_1, side = 1, V_0 = V_01, s_0 = 0, p_ambient = p_ambient, p_start = p_1_start) "Chamber 1";
  Chamber chamber_2(redeclare model Air = Air, A = A_2, side = -1, V_0 = V_02, s_0 = stroke, p_ambient = p_ambient, p_start = p_2_start) "Chamber 2";
  LaminarGap leak(G = C_i, mu_G = mu_C, followViscosity = followViscosity) "Leakage past the piston";
  LaminarGap rodLeak(G = C_e, mu_G = mu_C, followViscosity = followViscosity) if rodLeakage "Leakage past the rod";
  Tank outside(p = p_ambient) if rodLeakage "What drips off";
  Mechanical.Translational.Mass piston(m = m, s(start = s_start), v(start = v_start)) "Piston and rod";
  Mechanical.Translational.EndStops stops(s_min = 0, s_max = stroke, k = max(1e8, max(A_1, A_2)*p_rated/d_stop), d_0 = min(1e-4, d_stop)) "End stops";
  replaceable SealFriction.Stribeck seal constrainedby SealFriction.Law "Friction of the seals";
  SI.Position s(nominal = 0.1) "Position of the rod, 0 retracted";
  SI.Velocity v(nominal = 0.1) "Velocity of the rod";
  SI.Pressure p_1(nominal = 1e6) "Pressure of chamber 1";
  SI.Pressure p_2(nominal = 1e6) "Pressure of chamber 2";
protected
  parameter SI.Length d_stop = max(min(1e-3*stroke, min(V_01/A_1, V_02/A_2)/2), 1e-5) "Depth in an end stop at p_rated";
equation
  assert(stroke > 0, "The stroke must be positive");
  assert(s_start > -0.01*stroke and s_start < 1.01*stroke, "The position at the start s_start must lie from 0 to the stroke");
  connect(port_1, chamber_1.port);
  connect(port_2, chamber_2.port);
  connect(port_1, leak.port_a);
  connect(leak.port_b, port_2);
  connect(port_2, rodLeak.port_a);
  connect(rodLeak.port_b, outside.port);
  connect(chamber_1.flange, piston.flange_a);
  connect(chamber_2.flange, piston.flange_a);
  connect(seal.flange, piston.flange_a);
  connect(stops.flange, piston.flange_a);
  connect(piston.flange_b, flange);
  seal.p_1 = chamber_1.p - p_ambient;
  seal.p_2 = chamber_2.p - p_ambient;
  s = piston.s;
  v = piston.v;
  p_1 = chamber_1.p;
  p_2 = chamber_2.p;
  annotation(Documentation(info = "<html>
<p><code>V_1/beta dp_1/dt = q_1 - A_1 v - C_i (p_1 - p_2)</code>, <code>V_2/beta dp_2/dt = q_2 + A_2 v + C_i (p_1 - p_2)</code>,
<code>m dv/dt = A_1 p_1 - A_2 p_2 - p_a (A_1 - A_2) - f + f_flange</code> (the rod outside carries the surroundings). The friction is replaceable: <code>SealFriction.None</code>, <code>Viscous</code>,
<code>Stribeck</code> (default), <code>LuGre</code>, <code>Sticking</code>. So is the law of the air in the oil of the chambers (<code>EntrainedAir</code>).</p>
<p><b>End stops</b>: at <code>p_rated</code> on the whole area they give by <code>d_stop</code>, a thousandth of the stroke or half of what the volume left at the end allows, whichever is less, and are never softer than 1e8 N/m; damping by <code>Mechanical.Translational.EndStops</code>. A stiffness of one's own: <code>stops(k = ...)</code>.</p>
<p>Defaults: bore 80 mm, rod 40 mm, stroke 180 mm. For equal areas set A_2 = A_1. Source: Zhang et al., Processes 2021, 9, 814, section 3.3, with the two chambers apart.</p></html>"));
end Cylinder;
