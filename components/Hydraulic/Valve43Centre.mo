within Hydraulic;
model Valve43Centre "4/3 directional valve with a choice of the middle position"
  Interfaces.HydraulicPort port_P "Supply";
  Interfaces.HydraulicPort port_T "Return";
  Interfaces.HydraulicPort port_A "Consumer A";
  Interfaces.HydraulicPort port_B "Consumer B";
  Interfaces.RealInput u "Command, -1 to 1; positive joins P to A and B to T";
  outer Oil.Fluid oil "Oil of the circuit";
  replaceable Spool.SecondOrder spool constrainedby Spool.Law "Motion of the spool";
  parameter SpoolCentre centre = SpoolCentre.closed "What the middle position joins" annotation(Evaluate = true);
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Flow through one edge when open, at dp_nom";
  parameter SI.Pressure dp_nom(min = 1e3, max = 1e8, nominal = 1e6) = 5e5 "Pressure drop of q_nom at one edge";
  parameter Real overlap(unit = "1", min = 0, max = 0.5) = 0.1 "Travel before an edge opens that is closed in the middle";
  parameter Real underlap(unit = "1", min = 0.01, max = 0.9) = 0.1 "Travel after which an edge is closed that is open in the middle";
  parameter Real opening(unit = "1", min = 0.01, max = 1) = 0.5 "Opening in the middle of the edges open there, over the greatest";
  parameter Real rounding(unit = "1", min = 1e-4, max = 0.5) = 0.02 "Travel over which an edge opens smoothly";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-4 "Leakage cross section of an edge over its greatest";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  SpoolEdge edge_PA(A_max = A_P, overlap = overlap_P, rounding = rounding, leak = leak, C_d = C_d) "P to A";
  SpoolEdge edge_PB(A_max = A_P, overlap = overlap_P, rounding = rounding, leak = leak, C_d = C_d) "P to B";
  SpoolEdge edge_AT(A_max = A_T, overlap = overlap_T, rounding = rounding, leak = leak, C_d = C_d) "A to T";
  SpoolEdge edge_BT(A_max = A_T, overlap = overlap_T, rounding = rounding, leak = leak, C_d = C_d) "B to T";
  SpoolEdge edge_PT(A_max = A_PT, overlap = 0, rounding = rounding, leak = leak, C_d = C_d) if centre == SpoolCentre.tandem "P to T, open in the middle";
protected
  parameter Boolean open_P = centre == SpoolCentre.open or centre == SpoolCentre.regenerative "true: the edges at P are open in the middle" annotation(Evaluate = true);
  parameter Boolean open_T = centre == SpoolCentre.open or centre == SpoolCentre.float "true: the edges at T are open in the middle" annotation(Evaluate = true);
  parameter Real overlap_P(unit = "1") = if open_P then 0 else overlap "Overlap of the edges at P";
  parameter Real overlap_T(unit = "1") = if open_T then 0 else overlap "Overlap of the edges at T";
  parameter SI.Area A_nom = q_nom/(C_d*sqrt(2*dp_nom/oil.rho_0)) "Cross section that passes q_nom at dp_nom";
  parameter SI.Area A_P = A_nom/(1 + leak - rounding/(2*(1 - overlap_P))) "A_max of the edges at P: full travel gives A_nom";
  parameter SI.Area A_T = A_nom/(1 + leak - rounding/(2*(1 - overlap_T))) "A_max of the edges at T";
  parameter SI.Area A_PT = A_nom/(1 + leak - rounding/2) "A_max of the edge from P to T";
  Interfaces.RealOutput x_PT "Opening travel of the edge from P to T";
equation
  assert(q_nom > 0 and dp_nom > 0, "q_nom and dp_nom must be positive");
  assert(overlap >= 0 and overlap < 1, "The overlap must lie from 0 to below 1; for an edge that is open in the middle choose another centre");
  assert(underlap > 0 and opening > 0 and opening <= 1, "The underlap must be positive, the opening above 0, up to 1");
  connect(u, spool.u);
  edge_PA.x = if open_P then opening*min(1 + spool.y/underlap, 1) + (1 - opening)*max(spool.y, 0) else spool.y;
  edge_PB.x = if open_P then opening*min(1 - spool.y/underlap, 1) + (1 - opening)*max(-spool.y, 0) else -spool.y;
  edge_AT.x = if open_T then opening*min(1 - spool.y/underlap, 1) + (1 - opening)*max(-spool.y, 0) else -spool.y;
  edge_BT.x = if open_T then opening*min(1 + spool.y/underlap, 1) + (1 - opening)*max(spool.y, 0) else spool.y;
  x_PT = 1 - Smooth.mag(spool.y, 0.1*underlap)/underlap;
  connect(x_PT, edge_PT.x);
  connect(port_P, edge_PA.port_a);
  connect(edge_PA.port_b, port_A);
  connect(port_P, edge_PB.port_a);
  connect(edge_PB.port_b, port_B);
  connect(port_A, edge_AT.port_a);
  connect(edge_AT.port_b, port_T);
  connect(port_B, edge_BT.port_a);
  connect(edge_BT.port_b, port_T);
  connect(port_P, edge_PT.port_a);
  connect(edge_PT.port_b, port_T);
  annotation(Documentation(info = "<html><p>Edges, <code>SpoolEdge</code>, on one spool whose motion is replaceable. <code>centre</code> says what the middle position joins (<code>SpoolCentre</code>):</p>
<p>An edge closed in the middle opens after <code>overlap</code> in a straight line up to full travel. An edge open in the middle has there <code>opening</code> times its greatest cross section, grows from there in a straight line to full travel, and the other way closes at <code>underlap</code>: with the travel z in its opening direction <code>x = opening min(1 + z/underlap, 1) + (1 - opening) max(z, 0)</code>. With <code>tandem</code> a fifth edge joins P to T, full in the middle and closed 1.1 times <code>underlap</code> from it; the magnitude of the travel is rounded over a tenth of <code>underlap</code>.</p>
<p>Where <code>underlap</code> is greater than <code>overlap</code>, P, consumer and T are joined for a moment when the spool moves; where it is smaller, all are closed for a moment. At full travel an edge passes <code>q_nom</code> at <code>dp_nom</code>. Every edge is an orifice: passive, flow both ways. Flow forces are left out: valid where the spool is driven strongly enough. Sources: edges: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 5; middle positions: ISO 1219-1. The values are assumed.</p></html>"));
end Valve43Centre;
