within Hydraulic;
model Valve42 "4/2 way valve: P to B and A to T, or P to A and B to T"
  Interfaces.HydraulicPort port_P "Supply";
  Interfaces.HydraulicPort port_T "Return";
  Interfaces.HydraulicPort port_A "Consumer A";
  Interfaces.HydraulicPort port_B "Consumer B";
  Interfaces.RealInput u "Command: 1 joins P to A and B to T, 0 joins P to B and A to T";
  outer Oil.Fluid oil "Oil of the circuit";
  replaceable Spool.FirstOrder spool constrainedby Spool.Law "Motion of the spool";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Flow through one edge when open, at dp_nom";
  parameter SI.Pressure dp_nom(min = 1e3, max = 1e8, nominal = 1e6) = 5e5 "Pressure drop of q_nom at one edge";
  parameter Real overlap(unit = "1", min = -0.5, max = 0.5) = 0.1 "Part of half the travel that an edge is closed beyond the middle; negative: all ports joined on the way";
  parameter Real rounding(unit = "1", min = 1e-4, max = 0.5) = 0.02 "Part of half the travel over which an edge opens smoothly";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-4 "Leakage cross section of an edge over its greatest";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  SpoolEdge edge_PA(A_max = A_max, overlap = overlap, rounding = rounding, leak = leak, C_d = C_d) "P to A";
  SpoolEdge edge_PB(A_max = A_max, overlap = overlap, rounding = rounding, leak = leak, C_d = C_d) "P to B";
  SpoolEdge edge_AT(A_max = A_max, overlap = overlap, rounding = rounding, leak = leak, C_d = C_d) "A to T";
  SpoolEdge edge_BT(A_max = A_max, overlap = overlap, rounding = rounding, leak = leak, C_d = C_d) "B to T";
protected
  parameter SI.Area A_max = q_nom/(C_d*sqrt(2*dp_nom/oil.rho_0))/(1 + leak - rounding/(2*(1 - overlap))) "A_max of an edge: full travel passes q_nom at dp_nom";
equation
  assert(q_nom > 0 and dp_nom > 0, "q_nom and dp_nom must be positive");
  connect(u, spool.u);
  edge_PA.x = 2*min(max(spool.y, 0), 1) - 1;
  edge_BT.x = 2*min(max(spool.y, 0), 1) - 1;
  edge_PB.x = 1 - 2*min(max(spool.y, 0), 1);
  edge_AT.x = 1 - 2*min(max(spool.y, 0), 1);
  connect(port_P, edge_PA.port_a);
  connect(edge_PA.port_b, port_A);
  connect(port_P, edge_PB.port_a);
  connect(edge_PB.port_b, port_B);
  connect(port_A, edge_AT.port_a);
  connect(edge_AT.port_b, port_T);
  connect(port_B, edge_BT.port_a);
  connect(edge_BT.port_b, port_T);
  annotation(Documentation(info = "<html><p>Four edges, <code>SpoolEdge</code>, at <code>x = 2 y - 1</code> and <code>1 - 2 y</code>, y being the position from 0 to 1. Without current the spring joins P to B and A to T. On the way, around y = 1/2, all ports are closed with positive <code>overlap</code>, joined with a negative one. At the end of the travel an edge passes <code>q_nom</code> at <code>dp_nom</code>. Passive, flow both ways. Flow forces are left out. Sources: edges: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 5; symbol: ISO 1219-1.</p></html>"));
end Valve42;
