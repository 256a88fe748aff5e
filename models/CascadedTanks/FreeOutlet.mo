within CascadedTanks;
model FreeOutlet "Hole in the bottom of a tank, the jet falls freely"
  Interfaces.HydraulicPort port_a(p(nominal = 1e4)) "Bottom of the tank";
  Interfaces.HydraulicPort port_b(p(nominal = 1e4)) "Where the jet falls to; its pressure does not matter";
  parameter SI.Area a(min = 1e-7, max = 1e-2, nominal = 1e-5) = 3e-5 "Cross section of the jet";
  parameter SI.Density rho(min = 500, max = 2000) = 1000 "Density of the water";
  parameter SI.Pressure p_0(min = 0, nominal = 1e5) = 101325 "Pressure of the surroundings";
  parameter SI.Pressure w(min = 1e-3, nominal = 10) = 10 "Pressure below which the root is rounded";
  SI.VolumeFlowRate q(nominal = 1e-4) "Flow from a to b";
equation
  assert(a > 0 and w > 0, "a and w must be positive");
  q = a*sqrt(2/rho)*Smooth.root(port_a.p - p_0, w);
  port_a.q = q;
  port_b.q = -q;
  annotation(Documentation(info = "<html><p><code>q = a sqrt(2 (p - p_0)/rho)</code>, Torricelli's law; <code>w</code> is 1 mm of water.</p></html>"));
end FreeOutlet;
