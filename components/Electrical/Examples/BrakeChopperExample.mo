within Electrical.Examples;
model BrakeChopperExample "A braking drive feeds two links, one with a switched chopper, one with the mean of it"
  Signal.TimeTable braking(table = [0, 0; 0.05, 0; 0.1, 15; 0.3, 15; 0.35, 0; 0.4, -2; 0.5, -2]);
  SignalCurrent drive;
  Capacitor link(C = 1e-3, v_start = 650);
  BrakeChopper chopper(useHeatPort = true);
  SignalCurrent drive2;
  Capacitor link2(C = 1e-3, v_start = 650);
  BrakeChopper mean(averaged = true);
  Ground ground;
  Thermal.HeatCapacitor resistor(C = 100);
equation
  connect(braking.y, drive.i);
  connect(drive.n, link.p);
  connect(drive.p, link.n);
  connect(chopper.p, link.p);
  connect(chopper.n, link.n);
  connect(link.n, ground.p);
  connect(chopper.heatPort, resistor.port);
  connect(braking.y, drive2.i);
  connect(drive2.n, link2.p);
  connect(drive2.p, link2.n);
  connect(mean.p, link2.p);
  connect(mean.n, link2.n);
  connect(link2.n, ground.p);
  annotation(experiment(StartTime = 0, StopTime = 0.5, Interval = 0.0005, Tolerance = 1e-6));
end BrakeChopperExample;
