within Hydraulic;
model FlowSensor "Volume flow through a line"
  Interfaces.HydraulicPort port_a(dT_outflow = inStream(port_b.dT_outflow)) "Port a";
  Interfaces.HydraulicPort port_b(dT_outflow = inStream(port_a.dT_outflow)) "Port b";
  Interfaces.RealOutput q(unit = "m3/s", nominal = 1e-4) "Volume flow from a to b, at the pressure there";
equation
  port_a.p = port_b.p;
  port_a.q + port_b.q = 0;
  q = port_a.q;
  annotation(Documentation(info = "<html><p>Volume flow from a to b at the pressure of the line, without pressure drop.</p></html>"));
end FlowSensor;
