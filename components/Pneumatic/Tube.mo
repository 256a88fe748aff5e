within Pneumatic;
model Tube "Tube: resistance of its length and diameter, and its volume"
  PneumaticPort port_a "Port a";
  PneumaticPort port_b "Port b";
  outer Gas gas "Gas of the circuit";
  parameter SI.Length L(min = 1e-2, max = 200, nominal = 1) = 1 "Length";
  parameter SI.Diameter D(min = 1e-3, max = 0.1, nominal = 5e-3, displayUnit = "mm") = 4e-3 "Inner diameter";
  parameter SI.ThermalConductance G(min = 0, max = 1e6, nominal = 1) = 0 "Heat transfer to the wall; 0: adiabatic";
  parameter SI.Temperature T_wall(min = 1, max = 2000, nominal = 300, displayUnit = "degC") = gas.T_0 "Temperature of the wall";
  parameter SI.Pressure p_start(min = 1, max = 1e8, nominal = 1e5, displayUnit = "bar") = gas.p_0 "Pressure at the start";
  parameter SI.Temperature T_start(min = 1, max = 2000, nominal = 300, displayUnit = "degC") = gas.T_0 "Temperature at the start";
  final parameter Real C(unit = "m3/(s.Pa)") = 0.029*D^2/sqrt(L/D^1.25 + 510) "Sonic conductance of the tube";
  final parameter Real b(unit = "1") = 474*C/D^2 "Critical pressure ratio of the tube";
  Orifice half_a(C = C_h, b = b_h) "Resistance of the half at a";
  Orifice half_b(C = C_h, b = b_h) "Resistance of the half at b";
  Receiver content(V = Modelica.Constants.pi/4*D^2*L, G = G, T_wall = T_wall, p_start = p_start, T_start = T_start) "Content";
protected
  final parameter Real C_h(unit = "m3/(s.Pa)", fixed = false) "Sonic conductance of one half";
  final parameter Real b_h(unit = "1", fixed = false) "Critical pressure ratio of one half";
initial equation
  (C_h, b_h) = Functions.halfTube(C, b);
equation
  assert(L > 0 and D > 0, "The length L and the diameter D must be positive");
  connect(port_a, half_a.port_a);
  connect(half_a.port_b, content.port_a);
  connect(content.port_b, half_b.port_a);
  connect(half_b.port_b, port_b);
  annotation(Documentation(info = "<html>
<p><code>C = 0.029 D^2/sqrt(L/D^1.25 + 510)</code> in m3/(s.Pa), <code>b = 474 C/D^2</code>, L and D in metre: an empirical fit for smooth tubes with their fittings at the ends. Half of the resistance lies on either side of the content, see <code>Functions.halfTube</code>: the flow
through both is that of one <code>Orifice</code> of C and b where it is choked and up to 2 % below it elsewhere, 3 % at a pressure ratio of 0.99.</p>
<p>Valid for D from 2.5 to 9 mm and L from 0.2 to 20 m, where C lies 3 to 11 % below adiabatic flow with friction (Fanno, with the friction factor of Blasius and an entry loss of 0.5, at 7 bar).
One lump: waves and the delay <code>L/a</code> are left out; long tubes are several in a row. Laminar flow in the tube is left out: at small flows the true pressure drop is larger.</p>
<p>Source: a fit in common use for pneumatic tubes in the form of ISO 6358, C and b over L and D; friction of a gas in a duct: A. H. Shapiro, The Dynamics and Thermodynamics of Compressible Fluid Flow, Wiley 1953, chapter 6.</p></html>"));
end Tube;
