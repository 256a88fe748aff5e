within Pneumatic.Examples;
model CompressorExample "A compressor fills a receiver up to its relief valve"
  inner Gas gas "Air";
  Atmosphere atmosphere;
  Compressor compressor(V = 2e-4, useHeatPort = true);
  Mechanical.Rotational.ConstantSpeed motor(w_fixed = 150);
  Thermal.FixedTemperature room;
  Receiver receiver(V = 5e-3, G = 5);
  ReliefValve relief(p_set = 7e5);
  Atmosphere outside;
equation
  connect(motor.flange, compressor.flange);
  connect(compressor.heatPort, room.port);
  connect(atmosphere.port, compressor.port_a);
  connect(compressor.port_b, receiver.port_a);
  connect(receiver.port_b, relief.port_a);
  connect(relief.port_b, outside.port);
  annotation(experiment(StartTime = 0, StopTime = 20, Interval = 0.04, Tolerance = 1e-6));
end CompressorExample;
