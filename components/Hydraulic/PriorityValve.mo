within Hydraulic;
model PriorityValve "Priority valve: a flow for one consumer first, the rest to the other"
  Interfaces.HydraulicPort port_P "Inlet";
  Interfaces.HydraulicPort port_CF "Priority outlet";
  Interfaces.HydraulicPort port_EF "Outlet of the rest";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter Boolean useLS = false "true: the metering orifice lies outside, between port_CF and port_LS" annotation(Evaluate = true);
  Interfaces.HydraulicPort port_LS(p = p_LS, q = 0) if useLS "Pressure behind the metering orifice outside; takes no flow";
  parameter SI.VolumeFlowRate q_priority(min = 1e-8, max = 0.1, nominal = 1e-3) = 2e-4 "Priority flow, without useLS";
  parameter SI.Pressure dp_set(min = 1e4, max = 1e7, nominal = 1e6) = 8e5 "Pressure of the spring: drop over the metering orifice at which the priority outlet is closed";
  parameter Real droop(unit = "1", min = 0.005, max = 1) = 0.1 "Fall of that drop over the travel of the spool, over dp_set";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Flow through one edge when open, at dp_nom";
  parameter SI.Pressure dp_nom(min = 1e3, max = 1e7, nominal = 1e5) = 5e5 "Pressure drop of q_nom";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-2) = 5e-3 "Time constant of the spool";
  parameter Real rounding(unit = "1", min = 1e-4, max = 0.5) = 0.02 "Travel over which an edge opens smoothly";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-4 "Leakage cross section of an edge over its greatest";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  SpoolEdge edge_CF(A_max = A_max, rounding = rounding, leak = leak, C_d = C_d) "P to the priority outlet";
  SpoolEdge edge_EF(A_max = A_max, rounding = rounding, leak = leak, C_d = C_d) "P to the outlet of the rest";
  Orifice metering(A = q_priority/(C_d*sqrt(2*(1 - droop/2)*dp_set/oil.rho_0)), C_d = C_d) if not useLS "Metering orifice";
  Real x(unit = "1", start = 0, fixed = true) "Position of the spool: 0 all to the priority outlet, 1 all to the other";
  SI.Pressure p_LS(nominal = 1e6) "Pressure behind the metering orifice";
protected
  parameter SI.Area A_max = q_nom/(C_d*sqrt(2*dp_nom/oil.rho_0))/(1 + leak - rounding/2) "A_max of an edge: full travel passes q_nom at dp_nom";
equation
  assert(q_priority > 0 and q_nom > 0, "The flows q_priority and q_nom must be positive");
  assert(dp_set > 0 and droop > 0 and tau > 0, "dp_set, droop and tau must be positive");
  tau*der(x) = Smooth.clip((edge_CF.port_b.p - p_LS - (1 - droop)*dp_set)/(droop*dp_set), 0.1) - x;
  edge_CF.x = 1 - x;
  edge_EF.x = x;
  connect(port_P, edge_CF.port_a);
  connect(port_P, edge_EF.port_a);
  connect(edge_EF.port_b, port_EF);
  if useLS then
    connect(edge_CF.port_b, port_CF);
  else
    connect(edge_CF.port_b, metering.port_a);
    connect(metering.port_b, port_CF);
    p_LS = port_CF.p;
  end if;
  annotation(Documentation(info = "<html><p>The spool rests by its spring with the priority outlet open and the other closed. As the drop over the metering orifice rises from <code>(1 - droop) dp_set</code> to <code>dp_set</code> it travels to the other end: what the priority consumer does not take goes to the other, whichever of them has the higher pressure. <code>x = clip((p_CF - p_LS - (1 - droop) dp_set)/(droop dp_set))</code>, behind a lag, its corners rounded over a tenth of the travel; edges at <code>1 - x</code> and <code>x</code>.</p>
<p>Without <code>useLS</code> the metering orifice is inside and passes <code>q_priority</code> at the middle of the band. With it, it is outside (a steering unit): join <code>port_CF</code> before and <code>port_LS</code> behind it. With the priority consumer blocked no orifice inside sees a drop, and the pressure rises until a relief valve opens: put one at <code>port_CF</code>.</p>
<p>All is made of orifices: passive, flow both ways. Flow forces count as part of the droop; valid for frequencies below some 30 Hz. Source: W. Backe and H. Murrenhoff, Grundlagen der Oelhydraulik, 1994 (three-way flow control). The lag is assumed.</p></html>"));
end PriorityValve;
