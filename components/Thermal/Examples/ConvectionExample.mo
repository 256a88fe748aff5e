within Thermal.Examples;
model ConvectionExample "Cooling that sets in"
  HeatCapacitor body(C = 500, T_start = 350);
  Convection way;
  Signal.Step fan(height = 10, offset = 1, startTime = 100);
  PrescribedTemperature ambient;
  Signal.Sine day(amplitude = 5, f = 0.005, offset = 293.15);
  PrescribedHeatFlow heater;
  Signal.Constant power(k = 20);
equation
  connect(fan.y, way.Gc);
  connect(body.port, way.solid);
  connect(way.fluid, ambient.port);
  connect(day.y, ambient.T);
  connect(power.y, heater.Q_flow);
  connect(heater.port, body.port);
  annotation(experiment(StartTime = 0, StopTime = 500, Interval = 1, Tolerance = 1e-6));
end ConvectionExample;
