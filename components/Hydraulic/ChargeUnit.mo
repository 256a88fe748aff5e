within Hydraulic;
model ChargeUnit "Charge pump of a closed circuit: gear pump, relief valve and a check valve to each side"
  Interfaces.HydraulicPort port_a "Side A of the circuit";
  Interfaces.HydraulicPort port_b "Side B of the circuit";
  Interfaces.HydraulicPort port_tank "Tank";
  Interfaces.RotationalFlange flange "Shaft";
  parameter SI.Volume V(min = 1e-9, max = 1e-2, nominal = 1e-5, displayUnit = "ml") = 15e-6 "Displacement per revolution";
  parameter SI.Pressure p_charge(min = 1e5, max = 1e7, nominal = 1e6) = 2e6 "Setting of the relief valve, above the tank";
  parameter SI.Volume V_line(min = 1e-9, max = 1, nominal = 1e-4, displayUnit = "ml") = 2e-4 "Volume of the charge line";
  parameter SI.Pressure p_start(nominal = 1e6) = p_charge "Pressure of the charge line at the start";
  GearPump pump(V = V) "Gear pump";
  Volume line(V = V_line, p_start = p_start) "Charge line";
  ReliefValve relief(p_set = p_charge, q_nom = 5e-4, override = 0.1) "Relief valve";
  CheckValve check_A(A_max = 40e-6) "Check valve into A";
  CheckValve check_B(A_max = 40e-6) "Check valve into B";
equation
  assert(p_charge > 0, "The setting p_charge must be positive");
  connect(flange, pump.flange);
  connect(port_tank, pump.port_b);
  connect(pump.port_a, line.port);
  connect(line.port, relief.port_a);
  connect(relief.port_b, port_tank);
  connect(line.port, check_A.port_a);
  connect(check_A.port_b, port_a);
  connect(line.port, check_B.port_a);
  connect(check_B.port_b, port_b);
  annotation(Documentation(info = "<html><p>Replaces the leakage of a closed circuit and holds its low side at <code>p_charge</code>. One direction of rotation. Turned backwards it draws its line empty. Source: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001, closed circuits.</p></html>"));
end ChargeUnit;
