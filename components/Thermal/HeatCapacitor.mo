within Thermal;
model HeatCapacitor "Heat storage of one temperature"
  Interfaces.HeatPort port "Port";
  parameter SI.HeatCapacity C(min = 1e-6, max = 1e9, nominal = 1e3) = 1e3 "Heat capacity";
  parameter SI.Temperature T_start(min = 1) = 293.15 "Temperature at the start";
  SI.Temperature T(start = T_start, nominal = 300) "Temperature";
equation
  assert(C > 0, "The heat capacity C must be positive");
  T = port.T;
  C*der(T) = port.Q_flow;
  annotation(Documentation(info = "<html><p><code>C dT/dt = Q</code>, one temperature throughout: valid where heat spreads within the body faster than it leaves it (Biot number below 0.1).</p></html>"));
end HeatCapacitor;
