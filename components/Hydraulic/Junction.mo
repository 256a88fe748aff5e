within Hydraulic;
model Junction "Three-way junction: a small volume with a loss in each branch"
  Interfaces.HydraulicPort port_a "Branch a";
  Interfaces.HydraulicPort port_b "Branch b, straight on from a";
  Interfaces.HydraulicPort port_c "Branch c, at a right angle";
  parameter SI.Diameter d(min = 1e-3, max = 1, nominal = 1e-2) = 1e-2 "Diameter of the branches";
  parameter Real zeta_straight(unit = "1", min = 1e-3, max = 1e3) = 0.1 "Loss coefficient between a and b; half of it in each branch";
  parameter Real zeta_branch(unit = "1", min = 1e-3, max = 1e3) = 1.2 "Loss coefficient into or out of c";
  parameter SI.Volume V(min = 1e-9, max = 1, nominal = 1e-5, displayUnit = "ml") = 1e-5 "Volume";
  parameter SI.Pressure p_start(nominal = 1e6) = 101325 "Pressure at the start";
  LocalLoss loss_a(d = d, zeta = zeta_straight/2) "Loss in branch a";
  LocalLoss loss_b(d = d, zeta = zeta_straight/2) "Loss in branch b";
  LocalLoss loss_c(d = d, zeta = zeta_branch) "Loss in branch c";
  Volume volume(V = V, p_start = p_start) "Oil in the junction";
equation
  connect(port_a, loss_a.port_a);
  connect(port_b, loss_b.port_a);
  connect(port_c, loss_c.port_a);
  connect(loss_a.port_b, volume.port);
  connect(loss_b.port_b, volume.port);
  connect(loss_c.port_b, volume.port);
  annotation(Documentation(info = "<html><p><code>dp = zeta rho/2 v^2</code> in each branch by the speed of that branch. The real coefficients depend on how the flow divides (0.1 to 1.3); take them from a handbook where they matter.</p>
<p>Source: I. E. Idelchik, Handbook of Hydraulic Resistance, 2008, chapter 7, mean values for equal diameters. Valid where the branches carry similar flows.</p></html>"));
end Junction;
