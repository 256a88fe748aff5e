within Pneumatic;
model ThrottleCheckValve "Speed control valve: throttle from a to b, bypassed by a check valve from b to a"
  PneumaticPort port_a "Port a";
  PneumaticPort port_b "Port b";
  parameter Real C(unit = "m3/(s.Pa)", min = 1e-16, max = 1e-5, nominal = 1e-8) = 0.2e-8 "Sonic conductance of the throttle; 1e-8 m3/(s.Pa) is 1 dm3/(s.bar)";
  parameter Real b(unit = "1", min = 0, max = 0.8) = 0.3 "Critical pressure ratio of the throttle";
  parameter Real C_check(unit = "m3/(s.Pa)", min = 1e-14, max = 1e-5, nominal = 1e-8) = 1e-8 "Sonic conductance of the open check valve";
  parameter SI.Pressure p_crack(min = 0, max = 5e6, nominal = 1e4, displayUnit = "bar") = 0.05e5 "Pressure drop at which the check valve begins to open";
  parameter SI.Pressure p_open(min = 1, max = 1e7, nominal = 1e4, displayUnit = "bar") = 0.2e5 "Pressure drop at which the check valve is open";
  Orifice throttle(C = C, b = b) "Throttle";
  CheckValve check(C_max = C_check, p_crack = p_crack, p_open = p_open) "Bypass";
equation
  connect(port_a, throttle.port_a);
  connect(throttle.port_b, port_b);
  connect(port_b, check.port_a);
  connect(check.port_b, port_a);
  annotation(Documentation(info = "<html><p>A throttle from a to b with a check valve that opens from b to a. With a at the cylinder it throttles the exhaust (meter-out, the usual way), with b at the cylinder the supply. No mass of the poppet. Source: ISO 6358-1:2013 for the flow.</p></html>"));
end ThrottleCheckValve;
