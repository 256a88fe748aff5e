within Hydraulic.Examples;
model PolynomialMachineExample "A pump builds pressure against an orifice"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Ramp speed(height = 150, duration = 0.2);
  Mechanical.Rotational.Speed drive;
  PolynomialMachine pump(V = 10e-6);
  Tank tank;
  Volume volume(V = 2e-4);
  Orifice load(A = 1.2e-6);
equation
  connect(speed.y, drive.w_ref);
  connect(drive.flange, pump.flange);
  connect(pump.port_b, tank.port);
  connect(pump.port_a, volume.port);
  connect(volume.port, load.port_a);
  connect(load.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end PolynomialMachineExample;
