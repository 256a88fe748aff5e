within Hydraulic.Examples;
model UnloadingValveExample "A pump charges an accumulator and idles in between"
  inner Oil.ISOVG46 oil "Oil";
  FlowSource pump(q = 6e-4);
  Volume outlet(V = 1e-4);
  UnloadingValve valve(p_set = 150e5);
  CheckValve check;
  AccumulatorPolytropic accumulator(V_0 = 10e-3, p_pre = 90e5, p_start = 120e5);
  Orifice consumer(A = 2e-6);
  Tank tank;
equation
  connect(pump.port, outlet.port);
  connect(outlet.port, valve.port_a);
  connect(valve.port_b, tank.port);
  connect(outlet.port, check.port_a);
  connect(check.port_b, accumulator.port);
  connect(accumulator.port, valve.port_x);
  connect(accumulator.port, consumer.port_a);
  connect(consumer.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 20, Interval = 0.02, Tolerance = 1e-6));
end UnloadingValveExample;
