within Pneumatic;
model Valve22 "2/2 way valve, opened by a signal"
  PneumaticPort port_1 "Inlet";
  PneumaticPort port_2 "Outlet";
  Interfaces.RealInput u "Command: 1 opens, 0 closes";
  replaceable Hydraulic.Spool.FirstOrder spool constrainedby Hydraulic.Spool.Law "Motion of the spool";
  parameter Real C_max(unit = "m3/(s.Pa)", min = 1e-14, max = 1e-5, nominal = 1e-8) = 1e-8 "Sonic conductance of an open edge; 1e-8 m3/(s.Pa) is 1 dm3/(s.bar)";
  parameter Real b(unit = "1", min = 0, max = 0.8) = 0.3 "Critical pressure ratio";
  parameter Real overlap(unit = "1", min = -0.5, max = 0.5) = 0 "Travel before an edge opens";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-5 "Sonic conductance of a closed edge over C_max";
  SpoolEdge edge_12(C_max = C_max, b = b, overlap = overlap, leak = leak) "Port 1 to 2";
equation
  assert(C_max > 0, "The sonic conductance C_max must be positive");
  connect(u, spool.u);
  edge_12.x = 2*spool.y - 1;
  connect(port_1, edge_12.port_a);
  connect(edge_12.port_b, port_2);
  annotation(Documentation(info = "<html><p>u = 1 joins 1 and 2, u = 0 closes; the edge begins to open at half the travel. Each edge is a <code>SpoolEdge</code>, a restriction by ISO 6358 that passes both directions; the motion of the spool is replaceable (<code>Hydraulic.Spool.FirstOrder</code>, time constant <code>tau</code>, is the default, at rest at the start). Flow forces and the dead time of a solenoid are left out. Source: ISO 6358-1:2013 for the flow; numbers of the ports by ISO 11727:1999.</p></html>"));
end Valve22;
