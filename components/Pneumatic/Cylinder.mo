within Pneumatic;
model Cylinder "Double-acting cylinder: two chambers, seal friction, leakage, end stops, mass of the piston"
  PneumaticPort port_1 "Chamber 1; its pressure extends the rod";
  PneumaticPort port_2 "Chamber 2; its pressure retracts the rod";
  Interfaces.TranslationalFlange flange "Rod";
  outer Gas gas "Gas of the circuit";
  parameter SI.Area A_1(min = 1e-8, max = 10, nominal = 1e-3, displayUnit = "cm2") = 8.042e-4 "Area of chamber 1";
  parameter SI.Area A_2(min = 1e-8, max = 10, nominal = 1e-3, displayUnit = "cm2") = 6.912e-4 "Area of chamber 2";
  parameter SI.Length stroke(min = 1e-3, max = 100, nominal = 0.1, displayUnit = "mm") = 0.2 "Stroke";
  parameter SI.Volume V_01(min = 1e-8, max = 1, nominal = 1e-5, displayUnit = "ml") = 1e-5 "Volume of chamber 1 at s = 0, fully retracted, with the line";
  parameter SI.Volume V_02(min = 1e-8, max = 1, nominal = 1e-5, displayUnit = "ml") = 1e-5 "Volume of chamber 2 at s = stroke, fully extended, with the line";
  parameter SI.Mass m(min = 1e-3, max = 1e6, nominal = 1) = 0.5 "Mass of piston and rod";
  parameter SI.TranslationalSpringConstant c_stop(min = 1e6, max = 1e12, nominal = 1e7) = max(1e7, max(A_1, A_2)*p_rated/d_stop) "Stiffness of the end stops";
  parameter SI.Pressure p_rated(min = 1e4, max = 1e8, nominal = 1e6, displayUnit = "bar") = 16e5 "Pressure that the end stops are made for";
  parameter SI.ThermalConductance G_1(min = 0, max = 1e6, nominal = 1) = 0 "Heat transfer of chamber 1 to the wall; 0: adiabatic";
  parameter SI.ThermalConductance G_2(min = 0, max = 1e6, nominal = 1) = 0 "Heat transfer of chamber 2 to the wall; 0: adiabatic";
  parameter SI.Temperature T_wall(min = 1, max = 2000, nominal = 300, displayUnit = "degC") = gas.T_0 "Temperature of the wall";
  parameter Boolean pistonLeakage = false "true: with leakage past the piston" annotation(Evaluate = true);
  parameter Real C_i(unit = "m3/(s.Pa)", min = 1e-16, max = 1e-8, nominal = 1e-11) = 1e-11 "Sonic conductance of the leakage past the piston";
  parameter SI.Pressure p_ambient(min = 0, nominal = 1e5, displayUnit = "bar") = gas.p_0 "Pressure on the rod outside";
  parameter SI.Position s_start(nominal = 0.1, displayUnit = "mm") = 0 "Position at the start";
  parameter SI.Velocity v_start(nominal = 0.1) = 0 "Velocity at the start";
  parameter SI.Pressure p_1_start(min = 1, max = 1e8, nominal = 1e5, displayUnit = "bar") = gas.p_0 "Pressure of chamber 1 at the start";
  parameter SI.Pressure p_2_start(min = 1, max = 1e8, nominal = 1e5, displayUnit = "bar") = gas.p_0 "Pressure of chamber 2 at the start";
  parameter SI.Temperature T_start(min = 1, max = 2000, nominal = 300, displayUnit = "degC") = gas.T_0 "Temperature of both chambers at the start";
  Chamber chamber_1(A = A_1, side = 1, V_0 = V_01, s_0 = 0, p_ambient = p_ambient, p_start = p_1_start, T_start = T_start, G = G_1, T_wall = T_wall) "Chamber 1";
  Chamber chamber_2(A = A_2, side = -1, V_0 = V_02, s_0 = stroke, p_ambient = p_ambient, p_start = p_2_start, T_start = T_start, G = G_2, T_wall = T_wall) "Chamber 2";
  Orifice leak(C = C_i) if pistonLeakage "Leakage past the piston";
  Mechanical.Translational.Mass piston(m = m, s(start = s_start), v(start = v_start)) "Piston and rod";
  Mechanical.Translational.EndStops stops(s_min = 0, s_max = stroke, k = c_stop, c = 10*c_stop, d_0 = min(1e-4, d_stop)) "End stops";
  replaceable Hydraulic.SealFriction.Stribeck seal(F_0 = 15, k_c = 2e-5, v_brk = 0.01, B = 50) constrainedby Hydraulic.SealFriction.Law "Friction of the seals";
  SI.Position s(nominal = 0.1) "Position of the rod, 0 retracted";
  SI.Velocity v(nominal = 0.1) "Velocity of the rod";
  SI.Pressure p_1(nominal = 1e5) "Pressure of chamber 1";
  SI.Pressure p_2(nominal = 1e5) "Pressure of chamber 2";
protected
  parameter SI.Length d_stop = max(min(1e-3*stroke, min(V_01/A_1, V_02/A_2)/2), 1e-5) "Depth in an end stop at p_rated";
equation
  assert(stroke > 0, "The stroke must be positive");
  assert(s_start > -0.01*stroke and s_start < 1.01*stroke, "The position at the start s_start must lie from 0 to the stroke");
  assert(V_01 > 5e-4*A_1, "The volume V_01 left at the end of the stroke must exceed A_1 times 0.5 mm, by which the end stop may give way");
  assert(V_02 > 5e-4*A_2, "The volume V_02 left at the end of the stroke must exceed A_2 times 0.5 mm, by which the end stop may give way");
  connect(port_1, chamber_1.port);
  connect(port_2, chamber_2.port);
  connect(port_1, leak.port_a);
  connect(leak.port_b, port_2);
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
<p>Two <code>Chamber</code>s on one piston, <code>m dv/dt = A_1 p_1 - A_2 p_2 - p_a (A_1 - A_2) - f + f_flange</code> (the rod outside carries the surroundings). The friction is replaceable, the laws are those of <code>Hydraulic.SealFriction</code>:
<code>None</code>, <code>Viscous</code>, <code>Stribeck</code> (default, creeps under load), <code>LuGre</code>, <code>Sticking</code>. The end stops are elastic and damped, <code>Mechanical.Translational.EndStops</code>, damping <code>10 c_stop</code> per metre and m/s; at <code>p_rated</code> on the whole area they give by a thousandth of the stroke or half of what the volume left at the end allows, whichever is less, and are never softer than 1e7 N/m. Cushioning of the end positions is left out. The heat of friction is not given to the gas.</p>
<p>Defaults: bore 32 mm, rod 12 mm, stroke 200 mm, friction assumed, some 8 % of the force at 6 bar. Adiabatic unless <code>G_1</code>, <code>G_2</code> are set: with a coefficient of 20 to 60 W/(m2 K) and the surface at half the stroke a cylinder of this size has some 0.3 to 1 W/K.</p>
<p>Source: P. Beater, Pneumatic Drives, Springer 2007, chapter on cylinders.</p></html>"));
end Cylinder;
