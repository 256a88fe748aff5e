within Hydraulic;
model ThrottleCheckValve "Throttle from a to b, bypassed by a check valve from b to a"
  Interfaces.HydraulicPort port_a "Port a";
  Interfaces.HydraulicPort port_b "Port b";
  parameter SI.Area A(min = 1e-14, max = 1e-2, nominal = 1e-6, displayUnit = "mm2") = 1e-6 "Cross section of the throttle";
  parameter SI.Area A_check(min = 1e-10, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 1e-5 "Cross section of the open check valve";
  Orifice throttle(A = A) "Throttle";
  CheckValve check(A_max = A_check) "Bypass";
equation
  connect(port_a, throttle.port_a);
  connect(throttle.port_b, port_b);
  connect(port_b, check.port_a);
  connect(check.port_b, port_a);
  annotation(Documentation(info = "<html><p>A throttle from a to b with a check valve that opens from b to a. No mass of the poppet.</p></html>"));
end ThrottleCheckValve;
