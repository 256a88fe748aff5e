within Hydraulic;
model Valve32 "3/2 way valve: A joined to P or to T"
  Interfaces.HydraulicPort port_P "Supply";
  Interfaces.HydraulicPort port_T "Return";
  Interfaces.HydraulicPort port_A "Consumer";
  Interfaces.RealInput u "Command: 1 joins P to A, 0 joins A to T";
  replaceable Spool.FirstOrder spool constrainedby Spool.Law "Motion of the spool";
  parameter SI.Area A_max(min = 1e-10, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 1e-5 "Cross section when open";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-4 "Leakage cross section over A_max";
  SpoolEdge edge_PA(A_max = A_max, leak = leak) "P to A";
  SpoolEdge edge_AT(A_max = A_max, leak = leak) "A to T";
equation
  connect(u, spool.u);
  edge_PA.x = 2*spool.y - 1;
  edge_AT.x = 1 - 2*spool.y;
  connect(port_P, edge_PA.port_a);
  connect(edge_PA.port_b, port_A);
  connect(port_A, edge_AT.port_a);
  connect(edge_AT.port_b, port_T);
  annotation(Documentation(info = "<html><p>u = 1 joins P to A, u = 0 joins A to T, both closed in between; motion of the spool by <code>Spool</code>, replaceable. Flow forces are left out.</p></html>"));
end Valve32;
