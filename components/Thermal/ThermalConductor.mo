within Thermal;
model ThermalConductor "Heat conduction in proportion to the difference of temperature"
  Interfaces.HeatPort port_a "Port a";
  Interfaces.HeatPort port_b "Port b";
  parameter SI.ThermalConductance G(min = 0, max = 1e6, nominal = 10) = 10 "Conductance";
  SI.HeatFlowRate Q_flow "Heat flow from a to b";
equation
  assert(G >= 0, "The conductance G must not be negative");
  Q_flow = G*(port_a.T - port_b.T);
  port_a.Q_flow = Q_flow;
  port_b.Q_flow = -Q_flow;
  annotation(Documentation(info = "<html><p><code>Q = G (T_a - T_b)</code>: conduction through a wall, or convection at a constant coefficient times area. Takes no heat itself.</p></html>"));
end ThermalConductor;
