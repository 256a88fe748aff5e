within Pneumatic;
model QuickExhaust "Quick exhaust valve: fills from 1 to 2, empties from 2 straight to 3"
  PneumaticPort port_1 "Inlet, from the way valve";
  PneumaticPort port_2 "Consumer";
  PneumaticPort port_3 "Exhaust";
  parameter Real C_12(unit = "m3/(s.Pa)", min = 1e-14, max = 1e-5, nominal = 1e-8) = 1e-8 "Sonic conductance of 1 to 2; 1e-8 m3/(s.Pa) is 1 dm3/(s.bar)";
  parameter Real C_23(unit = "m3/(s.Pa)", min = 1e-14, max = 1e-5, nominal = 1e-8) = 2e-8 "Sonic conductance of 2 to 3";
  parameter Real b(unit = "1", min = 0, max = 0.8) = 0.3 "Critical pressure ratio of both";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-5 "Sonic conductance of a closed seat over that of the open one";
  parameter SI.Pressure p_crack(min = 0, max = 5e6, nominal = 1e4, displayUnit = "bar") = 0.05e5 "Pressure difference of 1 and 2 at which the seal begins to leave either seat";
  parameter SI.Pressure p_open(min = 1, max = 1e7, nominal = 1e4, displayUnit = "bar") = 0.2e5 "Pressure difference of 1 and 2 at which a seat is open";
  CheckValve inlet(C_max = C_12, b = b, leak = leak, p_crack = p_crack, p_open = p_open) "1 to 2";
  VariableOrifice exhaust(C_max = C_23, b = b, leak = leak) "2 to 3";
equation
  assert(p_open > p_crack, "p_open must lie above p_crack");
  exhaust.u = Smooth.step((port_2.p - port_1.p - p_crack)/(p_open - p_crack));
  connect(port_1, inlet.port_a);
  connect(inlet.port_b, port_2);
  connect(port_2, exhaust.port_a);
  connect(exhaust.port_b, port_3);
  annotation(Documentation(info = "<html><p>The seal stands on the exhaust while the pressure at 1 exceeds that at 2, and on the inlet while it is the other way; between, within <code>p_crack</code>, both are closed. Openings are smooth over <code>p_crack</code> to <code>p_open</code>, without mass of the seal. Source: ISO 6358-1:2013 for the flow; P. Beater, Pneumatic Drives, Springer 2007, chapter on valves.</p></html>"));
end QuickExhaust;
