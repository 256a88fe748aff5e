within Pneumatic;
model Reservoir "Gas of constant pressure and temperature"
  PneumaticPort port "Port";
  outer Gas gas "Gas of the circuit";
  parameter SI.Pressure p(min = 0, max = 1e8, nominal = 1e5, displayUnit = "bar") = 7e5 "Pressure, absolute";
  parameter SI.Temperature T(min = 1, max = 2000, nominal = 300, displayUnit = "degC") = gas.T_0 "Temperature of gas that leaves";
equation
  assert(p >= 0 and T > 0, "The pressure p must not be negative, the temperature T must be positive");
  port.p = p;
  port.h_outflow = gas.c_p*T;
  annotation(Documentation(info = "<html><p>Takes and gives any mass at one pressure; gas leaves with the temperature T. A supply net, or a large vessel.</p></html>"));
end Reservoir;
