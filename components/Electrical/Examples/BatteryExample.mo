within Electrical.Examples;
model BatteryExample "A pulse of discharge, a rest, a pulse of charge; one RC pair and two"
  Signal.TimeTable pulse(table = [0, 0; 10, 0; 10, 20; 70, 20; 70, 0; 200, 0; 200, -20; 260, -20; 260, 0]);
  SignalCurrent load;
  Battery one(useHeatPort = true);
  SignalCurrent load2;
  Battery two(cells = 12, R_0 = 12e-3, R_1 = 6e-3, R_2 = 8e-3, T_2 = 60, twoPairs = true);
  Ground ground;
  Thermal.HeatCapacitor cell(C = 800);
equation
  connect(pulse.y, load.i);
  connect(one.p, load.p);
  connect(one.n, load.n);
  connect(one.n, ground.p);
  connect(one.heatPort, cell.port);
  connect(pulse.y, load2.i);
  connect(two.p, load2.p);
  connect(two.n, load2.n);
  connect(two.n, ground.p);
  annotation(experiment(StartTime = 0, StopTime = 400, Interval = 0.5, Tolerance = 1e-7));
end BatteryExample;
