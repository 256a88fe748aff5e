within Hydraulic;
model PowerSensor "Hydraulic power that passes a line"
  Interfaces.HydraulicPort port_a(dT_outflow = inStream(port_b.dT_outflow)) "Port a";
  Interfaces.HydraulicPort port_b(dT_outflow = inStream(port_a.dT_outflow)) "Port b";
  Interfaces.RealOutput power(unit = "W") "Absolute pressure less p_ref, times the volume flow from a to b";
  parameter SI.Pressure p_ref(min = 0, nominal = 1e5) = 101325 "Pressure against which the power counts";
equation
  port_a.p = port_b.p;
  port_a.q + port_b.q = 0;
  power = (port_a.p - p_ref)*port_a.q;
  annotation(Documentation(info = "<html><p>Without influence on the circuit.</p></html>"));
end PowerSensor;
