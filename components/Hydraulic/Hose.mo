within Hydraulic;
model Hose "Short hose: oil and wall as one volume between two resistances"
  Interfaces.HydraulicPort port_a "Port a";
  Interfaces.HydraulicPort port_b "Port b";
  parameter SI.Length L(min = 1e-3, max = 100, nominal = 1) = 1 "Length";
  parameter SI.Diameter d(min = 1e-4, max = 1, nominal = 1e-2) = 1e-2 "Inner diameter";
  parameter SI.BulkModulus beta_wall(min = 1e6, nominal = 1e9) = 7e8 "Modulus of the wall, 0.5 to 1 GPa";
  parameter SI.Pressure p_start(nominal = 1e6) = 101325 "Pressure at the start";
  replaceable model Air = EntrainedAir.Frozen constrainedby EntrainedAir.Law "What becomes of the air in the oil";
  PipeResistance half_a(L = L/2, d = d) "First half";
  PipeResistance half_b(L = L/2, d = d) "Second half";
  Volume volume(redeclare model Air = Air, V = Modelica.Constants.pi*d^2/4*L, beta_wall = beta_wall, p_start = p_start) "Oil and wall";
equation
  connect(port_a, half_a.port_a);
  connect(half_a.port_b, volume.port);
  connect(volume.port, half_b.port_a);
  connect(half_b.port_b, port_b);
  annotation(Documentation(info = "<html><p>Two halves of a resistance with a compliant volume between; the inertia of the oil is left out. For waves take <code>Line</code> with <code>beta_wall</code>. Valid below a tenth of <code>c/L</code>. Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 3.10.</p></html>"));
end Hose;
