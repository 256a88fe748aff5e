within Hydraulic;
model FlowDivider "Flow divider and combiner, spool type: shares a flow whatever the loads"
  Interfaces.HydraulicPort port_P "Common port";
  Interfaces.HydraulicPort port_A "Branch A";
  Interfaces.HydraulicPort port_B "Branch B";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter Real share(unit = "1", min = 0.05, max = 0.95) = 0.5 "Part of the flow that branch A gets";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Nominal flow at P";
  parameter SI.Pressure dp_nom(min = 1e3, max = 1e7, nominal = 1e6) = 8e5 "Pressure drop of the metering orifices at q_nom";
  parameter SI.Pressure dp_edge(min = 1e3, max = 1e7, nominal = 1e5) = 2e5 "Pressure drop of an open edge at its part of q_nom";
  parameter Real droop(unit = "1", min = 1e-3, max = 1) = 0.05 "Difference of the metering drops that closes an edge, over dp_nom";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-2) = 5e-3 "Time constant of the spool";
  parameter Real rounding(unit = "1", min = 1e-4, max = 0.5) = 0.02 "Travel over which an edge opens smoothly";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-3 "Leakage cross section of an edge over its greatest";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  Orifice metering_A(A = share*A_nom, C_d = C_d) "Metering orifice of branch A";
  Orifice metering_B(A = (1 - share)*A_nom, C_d = C_d) "Metering orifice of branch B";
  SpoolEdge edge_A(A_max = share*A_edge, rounding = rounding, leak = leak, C_d = C_d) "To branch A";
  SpoolEdge edge_B(A_max = (1 - share)*A_edge, rounding = rounding, leak = leak, C_d = C_d) "To branch B";
  Real x(unit = "1", start = 0, fixed = true) "Position of the spool: 1 branch B is closed, -1 branch A is";
protected
  parameter SI.Area A_nom = q_nom/(C_d*sqrt(2*dp_nom/oil.rho_0)) "Cross section of both metering orifices";
  parameter SI.Area A_edge = q_nom/(C_d*sqrt(2*dp_edge/oil.rho_0))/(1 + leak - rounding/2) "A_max of both edges";
  SI.Pressure dp_A(nominal = 1e6) "Metering drop of branch A, from P";
  SI.Pressure dp_B(nominal = 1e6) "Metering drop of branch B, from P";
equation
  assert(share > 0 and share < 1, "The share of branch A must lie between 0 and 1");
  assert(q_nom > 0 and dp_nom > 0 and dp_edge > 0, "q_nom, dp_nom and dp_edge must be positive");
  assert(droop > 0 and tau > 0, "droop and tau must be positive");
  dp_A = metering_A.dp;
  dp_B = metering_B.dp;
  tau*der(x) = min(max(Smooth.sgn(dp_A + dp_B, 0.01*dp_nom)*(dp_B - dp_A)/(droop*dp_nom), -1), 1) - x;
  edge_A.x = 1 + min(x, 0);
  edge_B.x = 1 - max(x, 0);
  connect(port_P, metering_A.port_a);
  connect(metering_A.port_b, edge_A.port_a);
  connect(edge_A.port_b, port_A);
  connect(port_P, metering_B.port_a);
  connect(metering_B.port_b, edge_B.port_a);
  connect(edge_B.port_b, port_B);
  annotation(Documentation(info = "<html><p>Each branch has a fixed metering orifice; the spool compares their drops and throttles the branch that has too much. Dividing, that is the branch of lower pressure, combining, that of higher pressure: the two halves of the spool move apart with the flow out of P and together with the flow into P, which turns the sign. <code>x = (dp_B - dp_A)/(droop dp_nom)</code>, times the sign of <code>dp_A + dp_B</code> (rounded over a hundredth of <code>dp_nom</code>), limited to -1 to 1, behind a lag; edges at <code>1 + min(x, 0)</code> and <code>1 - max(x, 0)</code>.</p>
<p>The error of the shares is at most some <code>droop/4</code> at <code>q_nom</code>, and grows as the inverse square of the flow: below a third of <code>q_nom</code> it is not good for much, as on the bench. With a branch blocked the other is nearly closed too and passes <code>leak</code>: real valves have such a bleed to run both consumers to their ends. All is made of orifices: passive, flow both ways. Flow forces count as part of the droop. Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1: Hydraulik, 2012; the values are assumed.</p></html>"));
end FlowDivider;
