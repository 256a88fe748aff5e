within Hydraulic;
model Valve43 "4/3 proportional or servo valve with four metering edges"
  Interfaces.HydraulicPort port_P "Supply";
  Interfaces.HydraulicPort port_T "Return";
  Interfaces.HydraulicPort port_A "Consumer A";
  Interfaces.HydraulicPort port_B "Consumer B";
  Interfaces.RealInput u "Command, -1 to 1; positive joins P to A and B to T";
  outer Oil.Fluid oil "Oil of the circuit";
  replaceable Spool.SecondOrder spool constrainedby Spool.Law "Motion of the spool";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Flow through one edge when open, at dp_nom";
  parameter SI.Pressure dp_nom(min = 1e3, nominal = 1e6) = 5e5 "Pressure drop of q_nom at one edge";
  parameter Real overlap(unit = "1", min = -0.5, max = 0.5) = 0 "Travel before an edge opens: 0 servo valve, 0.1 to 0.2 proportional valve";
  parameter Real rounding(unit = "1", min = 1e-4, max = 0.5) = 0.02 "Travel over which an edge opens smoothly";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-4 "Leakage cross section of an edge over its greatest";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  SpoolEdge edge_PA(A_max = A_max, overlap = overlap, rounding = rounding, leak = leak, C_d = C_d) "P to A";
  SpoolEdge edge_PB(A_max = A_max, overlap = overlap, rounding = rounding, leak = leak, C_d = C_d) "P to B";
  SpoolEdge edge_AT(A_max = A_max, overlap = overlap, rounding = rounding, leak = leak, C_d = C_d) "A to T";
  SpoolEdge edge_BT(A_max = A_max, overlap = overlap, rounding = rounding, leak = leak, C_d = C_d) "B to T";
protected
  parameter SI.Area A_max = q_nom/(C_d*sqrt(2*dp_nom/oil.rho_0)) "Cross section of an open edge";
equation
  assert(q_nom > 0 and dp_nom > 0, "q_nom and dp_nom must be positive");
  connect(u, spool.u);
  edge_PA.x = spool.y;
  edge_BT.x = spool.y;
  edge_PB.x = -spool.y;
  edge_AT.x = -spool.y;
  connect(port_P, edge_PA.port_a);
  connect(edge_PA.port_b, port_A);
  connect(port_P, edge_PB.port_a);
  connect(edge_PB.port_b, port_B);
  connect(port_A, edge_AT.port_a);
  connect(edge_AT.port_b, port_T);
  connect(port_B, edge_BT.port_a);
  connect(edge_BT.port_b, port_T);
  annotation(Documentation(info = "<html><p>Four edges, <code>SpoolEdge</code>, on one spool whose motion is replaceable (<code>Spool.SecondOrder</code> with limited rate is the default). The nominal flow is that of one edge at <code>dp_nom</code>. Flow forces act on the spool in <code>Valve43FlowForce</code>. Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 5.</p></html>"));
end Valve43;
