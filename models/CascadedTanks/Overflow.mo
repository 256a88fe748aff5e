within CascadedTanks;
model Overflow "Edge of a tank: water above it runs over, part of it into another tank"
  Interfaces.HydraulicPort port_a(p(nominal = 1e4)) "Tank that runs over";
  Interfaces.HydraulicPort port_b(p(nominal = 1e4)) "Tank that catches a part of it";
  Interfaces.HydraulicPort drain(p(nominal = 1e4)) "Takes the rest";
  parameter SI.Height h_edge(min = 0, nominal = 1) = 1 "Height of the edge";
  parameter Real share(unit = "1", min = 0, max = 1) = 0.5 "Part that the other tank catches";
  parameter Real k(unit = "m2/s", min = 0, max = 1, nominal = 1e-2) = 1e-2 "Flow over the edge per height above it";
  parameter SI.Height w(min = 1e-6, nominal = 1e-3) = 5e-3 "Height over which the flow sets in";
  parameter SI.Density rho(min = 500, max = 2000) = 1000 "Density of the water";
  parameter SI.Pressure p_0(min = 0, nominal = 1e5) = 101325 "Pressure of the surroundings";
  SI.Height h(nominal = 0.5) "Level of the tank that runs over";
  SI.VolumeFlowRate q(nominal = 1e-4) "Flow over the edge";
equation
  assert(share >= 0 and share <= 1, "share must lie from 0 to 1");
  h = (port_a.p - p_0)/(rho*Modelica.Constants.g_n);
  q = k*Smooth.ramp(h - h_edge, w);
  port_a.q = q;
  port_b.q = -share*q;
  drain.q = -(1 - share)*q;
  annotation(Documentation(info = "<html><p><code>q = k (h - h_edge)</code> above the edge, set in over <code>w</code>. With <code>k</code> equal to the tank's cross section over 1 s the level hardly rises above the edge.</p></html>"));
end Overflow;
