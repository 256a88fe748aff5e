within ClosedCircuit;
model LoadPumpBench "The load machine of the whole bench alone, a gear pump against a proportional relief valve, at given speeds and commands"
  Interfaces.RealInput N(unit = "rev/min", start = 500, nominal = 1e3) "Speed";
  Interfaces.RealInput u(unit = "V", start = 3) "Command";
  inner Oil.ClosedCircuitOil oil "Oil";
  Mechanical.Rotational.Speed drive "Shaft";
  Mechanical.Rotational.Damper bearing(d = 0.1) "Friction of the load";
  Mechanical.Rotational.Fixed housing "Housing";
  Hydraulic.GearPump loadPump(V = 40e-6, G = 2e-12) "13: load pump";
  Hydraulic.Volume loadLine(V = 5e-4, p_start = 5e6) "Line of the load pump";
  Hydraulic.ProportionalRelief loadRelief(k_u = 3.14e6, R_ov = 1.1e10) "16: proportional relief valve";
  Hydraulic.Tank tank "Tank";
  Interfaces.RealOutput T(unit = "N.m", nominal = 100) "Torque that the load takes, with its friction";
equation
  drive.w_ref = Modelica.Units.Conversions.from_rpm(N);
  connect(drive.flange, bearing.flange_a);
  connect(bearing.flange_b, housing.flange);
  connect(drive.flange, loadPump.flange);
  connect(tank.port, loadPump.port_b);
  connect(loadPump.port_a, loadLine.port);
  connect(loadLine.port, loadRelief.port_a);
  connect(loadRelief.port_b, tank.port);
  connect(u, loadRelief.u);
  T = -drive.flange.tau;
  annotation(experiment(StartTime = 0, StopTime = 59, Interval = 1, Tolerance = 1e-6));
end LoadPumpBench;
