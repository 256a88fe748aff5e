within Hydraulic;
model FlowControlValve "Two-way flow control valve: a flow set by a signal, whatever the load"
  Interfaces.HydraulicPort port_a "Inlet";
  Interfaces.HydraulicPort port_b "Outlet";
  Interfaces.RealInput u "Flow commanded over q_nom, 0 to 1";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 5e-4 "Flow at u = 1";
  parameter SI.Pressure dp_set(min = 1e4, max = 1e7, nominal = 1e6) = 8e5 "Drop that the compensator holds over the metering orifice";
  parameter Real droop(unit = "1", min = 0.005, max = 1) = 0.1 "Fall of that drop from closed to fully open, over dp_set";
  parameter SI.Pressure dp_open(min = 1e3, nominal = 1e5) = 3e5 "Drop over the open compensator at q_nom";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-2) = 5e-3 "Time constant of the compensator";
  parameter SI.Area A_leak(min = 1e-16, max = 1e-6, nominal = 1e-10) = 1e-11 "Cross section at u = 0";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  PressureCompensator compensator(dp_set = dp_set, droop = droop, q_nom = q_nom, dp_nom = dp_open, tau = tau, C_d = C_d) "Compensator";
  VariableOrifice metering(A_max = q_nom/(C_d*sqrt(2*(1 - droop/2)*dp_set/oil.rho_0)), A_leak = A_leak, C_d = C_d) "Metering orifice";
  SI.VolumeFlowRate q(nominal = 1e-4) "Flow from a to b";
equation
  assert(q_nom > 0, "The flow q_nom must be positive");
  connect(port_a, compensator.port_a);
  connect(compensator.port_b, metering.port_a);
  connect(metering.port_b, port_b);
  connect(compensator.port_y, port_b);
  connect(u, metering.u);
  q = metering.q;
  annotation(Documentation(info = "<html><p><code>PressureCompensator</code> before a <code>VariableOrifice</code>. Above <code>dp_set + dp_open</code> in all the flow is <code>u q_nom</code> within about <code>droop/4</code>; below, the valve is two open orifices in series. Backwards the compensator stands open.</p>
<p>A step of the load passes until the spool has moved (<code>tau</code>): the known start-up jump. Source: W. Backe and H. Murrenhoff, Grundlagen der Oelhydraulik, 1994.</p></html>"));
end FlowControlValve;
