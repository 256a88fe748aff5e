within CascadedTanks;
model OpenTank "Open tank of constant cross section, port at the bottom"
  Interfaces.HydraulicPort port(p(nominal = 1e4)) "Port at the bottom, also for what falls in";
  parameter SI.Area A(min = 1e-6, max = 10, nominal = 1e-2) = 1e-2 "Cross section";
  parameter SI.Height h_start(min = 0, nominal = 0.5) = 0.5 "Level at the start";
  parameter SI.Density rho(min = 500, max = 2000) = 1000 "Density of the water";
  parameter SI.Pressure p_0(min = 0, nominal = 1e5) = 101325 "Pressure of the surroundings";
  SI.Height h(start = h_start, fixed = true, nominal = 0.5, stateSelect = StateSelect.prefer) "Level";
equation
  assert(A > 0, "The cross section A must be positive");
  A*der(h) = port.q;
  port.p = p_0 + rho*Modelica.Constants.g_n*h;
  annotation(Documentation(info = "<html><p><code>A dh/dt = q</code>, <code>p = p_0 + rho g h</code>.</p></html>"));
end OpenTank;
