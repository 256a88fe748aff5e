within Hydraulic;
model PressureReducerRelieving "Three-way pressure reducing valve: feeds the consumer, and relieves it to the tank when it is pushed back"
  Interfaces.HydraulicPort port_a "Supply";
  Interfaces.HydraulicPort port_b "Consumer at the reduced pressure";
  Interfaces.HydraulicPort port_t "Tank";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.Pressure p_set(min = 1e3, max = 1e8, nominal = 1e6) = 50e5 "Pressure at b above p_ref at which both ways are closed";
  parameter SI.Pressure p_ref(nominal = 1e5) = 101325 "Pressure of the spring chamber";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 5e-4 "Flow of a fully open way, at dp_nom";
  parameter SI.Pressure dp_nom(min = 1e3, nominal = 1e6) = 10e5 "Pressure drop of q_nom";
  parameter Real droop(unit = "1", min = 0.005, max = 1) = 0.1 "Change of the pressure at b from closed to fully open, over p_set";
  parameter Real overlap(unit = "1", min = 0, max = 1) = 0.2 "Travel between the ways, over that which opens one";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-2) = 1e-2 "Time constant of the spool";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section of a closed way";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  VariableOrifice feeding(A_max = A_max, A_leak = A_leak, C_d = C_d) "Supply to consumer";
  VariableOrifice relieving(A_max = A_max, A_leak = A_leak, C_d = C_d) "Consumer to tank";
  Real x(unit = "1", start = 0, fixed = true) "Spool: 1 feeds, -1 relieves";
protected
  parameter SI.Area A_max = q_nom/(C_d*sqrt(2*dp_nom/oil.rho_0)) "Cross section of an open way";
  Real s(unit = "1") "Pressure missing at b, over that which opens a way";
equation
  assert(p_set > 0 and q_nom > 0 and droop > 0 and tau > 0, "p_set, q_nom, droop and tau must be positive");
  s = (p_set - (port_b.p - p_ref))/(droop*p_set);
  tau*der(x) = Smooth.clip(s, 0.1) - Smooth.clip(-s - overlap, 0.1) - x;
  feeding.u = max(x, 0);
  relieving.u = max(-x, 0);
  connect(port_a, feeding.port_a);
  connect(feeding.port_b, port_b);
  connect(port_b, relieving.port_a);
  connect(relieving.port_b, port_t);
  annotation(Documentation(info = "<html><p>Below <code>p_set</code> it feeds b as <code>PressureReducer</code> does; from <code>(1 + overlap droop) p_set</code> on it lets oil from b to the tank, so that an outer force cannot raise the pressure at b. Between both it is closed. Mass of the spool and flow forces are in <code>tau</code> and <code>droop</code>. Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1: Hydraulik, 2012.</p></html>"));
end PressureReducerRelieving;
