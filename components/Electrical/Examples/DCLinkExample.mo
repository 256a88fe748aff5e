within Electrical.Examples;
model DCLinkExample "Charging from the mains, a drive that accelerates and brakes"
  Rectifier mains(L = 0.2e-3);
  Inductor choke(L = 1e-3);
  DCLink link(V_ready = 500, useHeatPort = true);
  Signal.TimeTable power(table = [0, 0; 0.4, 0; 0.5, 20; 0.7, 20; 0.8, -15; 1.1, -15; 1.2, 0]);
  SignalCurrent drive;
  Thermal.HeatCapacitor resistors(C = 500);
  Ground ground;
equation
  connect(mains.p, choke.p);
  connect(choke.n, link.p_in);
  connect(link.n, mains.n);
  connect(mains.n, ground.p);
  connect(power.y, drive.i);
  connect(drive.p, link.p);
  connect(drive.n, link.n);
  connect(link.heatPort, resistors.port);
  annotation(experiment(StartTime = 0, StopTime = 1.5, Interval = 0.001, Tolerance = 1e-6));
end DCLinkExample;
