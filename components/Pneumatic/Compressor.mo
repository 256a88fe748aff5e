within Pneumatic;
model Compressor "Piston compressor with automatic valves, polytropic, mean over a turn"
  PneumaticPort port_a(m_flow(min = 0)) "Suction";
  PneumaticPort port_b "Delivery";
  Interfaces.RotationalFlange flange "Shaft; either sense of rotation delivers";
  outer Gas gas "Gas of the circuit";
  parameter Boolean useHeatPort = false "true: the heat given off goes to what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -Q_cool) if useHeatPort "Heat given off by cooling and friction";
  parameter SI.Volume V(min = 1e-7, max = 1, nominal = 1e-4, displayUnit = "ml") = 1e-4 "Displacement a turn";
  parameter Real n(unit = "1", min = 1.01, max = 1.67) = 1.3 "Polytropic exponent, at most kappa";
  parameter Real epsilon(unit = "1", min = 0, max = 0.5) = 0.05 "Clearance volume over the displacement";
  parameter Real eta_m(unit = "1", min = 0.1, max = 1) = 0.9 "Mechanical efficiency";
  parameter SI.AngularVelocity w_0(min = 1e-3, max = 10, nominal = 1) = 0.5 "Speed over which the sense of rotation changes smoothly";
  SI.AngularVelocity w(nominal = 100) "Speed of the shaft";
  SI.MassFlowRate m_flow(nominal = 1e-2) "Mass flow from a to b";
  SI.VolumeFlowRate q(nominal = 1e-2) "Volume flow from a to b at the reference atmosphere (ANR)";
  SI.Power P(nominal = 1e3) "Power taken from the shaft";
  SI.HeatFlowRate Q_cool(nominal = 1e3) "Heat given off by cooling and friction";
  SI.Temperature T_b(nominal = 300) "Temperature of the gas delivered";
protected
  Real r(unit = "1") "Pressure ratio, at least 1";
  Real lambda(unit = "1") "Volumetric efficiency";
  Real g(unit = "1") "Rise of temperature over that at suction";
  SI.Temperature T_a(nominal = 300) "Temperature of the gas at suction";
  SI.Torque tau_i(nominal = 10) "Torque of the gas and of friction, without sign";
equation
  assert(V > 0, "The displacement V must be positive");
  assert(n > 1 and n <= gas.kappa, "The polytropic exponent n must lie above 1 and not above kappa of the gas");
  assert(eta_m > 0 and eta_m <= 1, "The mechanical efficiency eta_m must lie above 0 and not above 1");
  w = der(flange.phi);
  T_a = inStream(port_a.h_outflow)/gas.c_p;
  r = max(port_b.p/port_a.p, 1);
  lambda = max(1 - epsilon*(r^(1/n) - 1), 0);
  g = r^((n - 1)/n) - 1;
  T_b = T_a*(1 + g);
  m_flow = lambda*V/(2*Modelica.Constants.pi)*port_a.p/(gas.R_s*T_a)*w*Smooth.sgn(w, w_0);
  tau_i = lambda*V/(2*Modelica.Constants.pi)*port_a.p*n/(n - 1)*g/eta_m;
  flange.tau = tau_i*Smooth.sgn(w, w_0);
  P = flange.tau*w;
  Q_cool = P - m_flow*gas.c_p*(T_b - T_a);
  q = m_flow/gas.rho_0;
  port_a.m_flow = m_flow;
  port_b.m_flow = -m_flow;
  port_b.h_outflow = gas.c_p*T_b;
  port_a.h_outflow = inStream(port_b.h_outflow);
  annotation(Documentation(info = "<html>
<p><code>m_flow = lambda V abs(w)/(2 pi) p_a/(R_s T_a)</code> with <code>lambda = 1 - epsilon (r^(1/n) - 1)</code>, <code>r = p_b/p_a</code>, for the gas that expands from the clearance; no delivery where lambda would fall below 0.
Power <code>P = m_flow n/(n - 1) R_s T_a (r^((n - 1)/n) - 1)/eta_m</code>; the gas leaves with <code>T_a r^((n - 1)/n)</code>; what power exceeds its gain of enthalpy is given off as heat, never negative for <code>n <= kappa</code>.</p>
<p>Mean over a turn, without pulsation. The automatic valves let gas pass from a to b only, in either sense of rotation; <code>abs(w)</code> is <code>w tanh(w/w_0)</code>. Where p_b lies below p_a it delivers without taking work; that gas would also blow through while standing still is left out.</p>
<p>Source: P. Beater, Pneumatic Drives, Springer 2007, chapter on compressors; polytropic work and clearance as in any textbook of thermodynamics.</p></html>"));
end Compressor;
