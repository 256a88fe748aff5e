within Electrical.Examples;
model RectifierExample "Mean voltage at a load that draws more and more and then gives back"
  Rectifier rectifier(L = 0.5e-3, useHeatPort = true);
  Capacitor link(C = 1e-3, v_start = 500);
  Signal.TimeTable load(table = [0, 0; 0.1, 10; 0.3, 10; 0.4, 40; 0.6, 40; 0.7, -0.5; 1, -0.5]);
  SignalCurrent drive;
  Resistor inductive(R = 0.01);
  Inductor choke(L = 1e-3);
  Thermal.HeatCapacitor sink(C = 100);
  Ground ground;
equation
  connect(rectifier.p, inductive.p);
  connect(inductive.n, choke.p);
  connect(choke.n, link.p);
  connect(link.n, rectifier.n);
  connect(rectifier.n, ground.p);
  connect(load.y, drive.i);
  connect(drive.p, link.p);
  connect(drive.n, link.n);
  connect(rectifier.heatPort, sink.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.001, Tolerance = 1e-6));
end RectifierExample;
