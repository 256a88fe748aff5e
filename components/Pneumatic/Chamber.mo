within Pneumatic;
model Chamber "Chamber of a cylinder: gas behind a moving piston"
  extends Bases.Content;
  PneumaticPort port "Port";
  Interfaces.TranslationalFlange flange "Piston; moving it in the positive direction enlarges the chamber where side is 1";
  parameter SI.Area A(min = 1e-8, max = 10, nominal = 1e-3, displayUnit = "cm2") = 1e-3 "Area of the piston";
  parameter Integer side(min = -1, max = 1) = 1 "1: enlarges with positive motion, -1: shrinks";
  parameter SI.Volume V_0(min = 1e-9, max = 10, nominal = 1e-4, displayUnit = "ml") = 1e-5 "Volume at s = s_0, with all that is joined rigidly";
  parameter SI.Position s_0(nominal = 0.1) = 0 "Position of V_0";
  parameter SI.Pressure p_ambient(min = 0, nominal = 1e5, displayUnit = "bar") = gas.p_0 "Pressure on the other side of the piston, absolute";
  SI.Volume V(nominal = 1e-4) "Volume";
equation
  assert(A > 0, "The area A must be positive");
  assert(side == 1 or side == -1, "side must be 1 or -1");
  assert(V > 0, "The piston has passed the end of the chamber: the volume is negative");
  V = V_0 + side*A*(flange.s - s_0);
  V_gas = V;
  V_flow = side*A*der(flange.s);
  flange.f = -side*A*(p - p_ambient);
  port.p = p;
  port.h_outflow = gas.c_p*T;
  m_flow = port.m_flow;
  H_flow = max(port.m_flow, 0)*inStream(port.h_outflow) + min(port.m_flow, 0)*gas.c_p*T;
  annotation(Documentation(info = "<html>
<p><code>V dp/dt + kappa p A v = (kappa - 1)(m_flow h + Q_flow)</code>, see <code>Bases.Content</code>; force <code>A (p - p_ambient)</code>. Closed and adiabatic, <code>p V^kappa</code> stays constant. One pressure and one temperature throughout: no waves, valid while the piston is slow against the speed of sound.</p>
<p>Source: P. Beater, Pneumatic Drives, Springer 2007, chapter on chambers.</p></html>"));
end Chamber;
