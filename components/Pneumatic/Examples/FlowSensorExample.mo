within Pneumatic.Examples;
model FlowSensorExample "The standard volume flow into a vessel"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  FlowSensor sensor;
  Orifice orifice(C = 0.5e-8);
  Volume vessel(V = 1e-3);
equation
  connect(supply.port, sensor.port_a);
  connect(sensor.port_b, orifice.port_a);
  connect(orifice.port_b, vessel.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end FlowSensorExample;
