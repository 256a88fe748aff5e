within Hydraulic.PumpControl;
partial model Law "Control of a variable pump: lag and speed of the swash plate, limit of the torque"
  Interfaces.HydraulicPort port_p "Outlet of the pump; takes no flow";
  Interfaces.RealOutput u(start = u_start, fixed = true) "Displacement over the greatest one";
  parameter Real u_min(unit = "1", min = -1, max = 1) = 0 "Least displacement";
  parameter Real u_max(unit = "1", min = -1, max = 1) = 1 "Greatest displacement";
  parameter Real u_start(unit = "1", min = -1, max = 1) = u_max "Displacement at the start";
  parameter SI.Pressure p_set(min = 1e5, max = 1e8, nominal = 1e7) = 200e5 "Pressure above p_ref at which the pump has swung back";
  parameter SI.Pressure droop(min = 1e4, max = 1e7, nominal = 1e6) = 8e5 "Fall of the pressure from there to full displacement";
  parameter SI.Pressure p_ref(nominal = 1e5) = 101325 "Pressure of the spring chamber";
  parameter SI.Torque T_max(min = 0, nominal = 100) = 1e6 "Limit of the ideal torque";
  parameter SI.Volume V(min = 1e-9, max = 1e-2, nominal = 1e-5, displayUnit = "ml") = 1e-5 "Greatest displacement of the pump, for the limit of the torque";
  parameter SI.Time tau(min = 1e-4, max = 10, nominal = 1e-2) = 15e-3 "Time constant of small motions";
  parameter SI.Time T_up(min = 1e-3, max = 10, nominal = 0.1) = 0.1 "Shortest time of the full stroke outwards";
  parameter SI.Time T_down(min = 1e-3, max = 10, nominal = 0.1) = 0.05 "Shortest time of the full stroke back";
  SI.Pressure p(nominal = 1e7) "Pressure of the pump above p_ref";
  Real u_p(unit = "1") "Displacement that the pressures ask for";
protected
  Real u_T(unit = "1") "Displacement that the torque allows";
  Real goal(unit = "1") "Displacement aimed at";
equation
  assert(u_max > u_min, "u_max must lie above u_min");
  assert(p_set > droop and droop > 0 and tau > 0, "droop and tau must be positive, p_set above droop");
  p = port_p.p - p_ref;
  u_T = 2*Modelica.Constants.pi*T_max/(V*max(p, 1e5));
  goal = min(max(min(u_p, u_T), u_min), u_max);
  der(u) = min(max((goal - u)/tau, -1/T_down), 1/T_up);
  port_p.q = 0;
  annotation(Documentation(info = "<html><p>The swash plate follows with a lag <code>tau</code>, no faster than full stroke in <code>T_up</code> and <code>T_down</code>. Join <code>u</code> to a machine with <code>useInput</code>. The torque limit holds <code>u V p/(2 pi)</code> below <code>T_max</code>: with a motor of constant speed that is constant power. Oil for the control itself is left out.</p></html>"));
end Law;
