within Pneumatic;
model PressureRegulator "Pressure reducing valve from a to b, relieving or not"
  PneumaticPort port_a "Supply";
  PneumaticPort port_b "Reduced pressure";
  outer Gas gas "Gas of the circuit";
  parameter SI.Pressure p_set(min = 1e3, max = 1e7, nominal = 1e5, displayUnit = "bar") = 5e5 "Pressure at b above p_ref at which it is closed";
  parameter SI.Pressure p_ref(min = 0, max = 1e7, nominal = 1e5, displayUnit = "bar") = gas.p_0 "Pressure of the spring chamber, absolute";
  parameter Real C_max(unit = "m3/(s.Pa)", min = 1e-14, max = 1e-5, nominal = 1e-8) = 2e-8 "Sonic conductance when fully open; 1e-8 m3/(s.Pa) is 1 dm3/(s.bar)";
  parameter Real droop(unit = "1", min = 0.005, max = 1) = 0.1 "Fall of the pressure at b from closed to fully open, over p_set";
  parameter Boolean relieving = true "true: lets gas out of b where its pressure is too high" annotation(Evaluate = true);
  parameter Real C_r(unit = "m3/(s.Pa)", min = 1e-14, max = 1e-5, nominal = 1e-8) = 0.2e-8 "Sonic conductance of the open relief";
  parameter Real gap(unit = "1", min = 0, max = 1) = 0.04 "Rise of the pressure at b above p_set before the relief opens, over p_set";
  parameter Real b(unit = "1", min = 0, max = 0.8) = 0.3 "Critical pressure ratio";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-6 "Sonic conductance when closed over C_max";
  parameter SI.Time tau(min = 1e-5, max = 0.5, nominal = 1e-2) = 1e-2 "Time constant of the opening";
  VariableOrifice main(C_max = C_max, b = b, leak = leak) "Main seat";
  VariableOrifice relief(C_max = C_r, b = b, leak = leak) if relieving "Relief seat";
  Atmosphere atmosphere if relieving "Where the relief lets the gas out";
  Real x(unit = "1", start = 0, fixed = true) "Position: 0 to 1 main seat open, 0 to -1 relief open";
protected
  Interfaces.RealOutput u_relief "Opening of the relief";
  Real e(unit = "1") "Deviation of the pressure at b, over p_set";
equation
  assert(p_set > 0 and C_max > 0 and droop > 0 and tau > 0, "p_set, C_max, droop and tau must be positive");
  e = (port_b.p - p_ref)/p_set - 1;
  tau*der(x) = Smooth.clip(-e/droop, 0.1) - Smooth.clip((e - gap)/droop, 0.1) - x;
  main.u = x;
  u_relief = -x;
  connect(u_relief, relief.u);
  connect(port_a, main.port_a);
  connect(main.port_b, port_b);
  connect(port_b, relief.port_a);
  connect(relief.port_b, atmosphere.port);
  annotation(Documentation(info = "<html><p>The main seat opens in proportion to the fall of the pressure at b below <code>p_set</code>, fully at <code>p_set (1 - droop)</code>, corners rounded over a tenth of the range, with a lag <code>tau</code>. A relieving regulator lets gas out of b above <code>p_set (1 + gap)</code>; one that is not relieving only closes. Hysteresis and the influence of the supply pressure are left out. Source: form of <code>Hydraulic.PressureReducer</code>; terms by ISO 6953-1:2015; flow by ISO 6358-1:2013.</p></html>"));
end PressureRegulator;
