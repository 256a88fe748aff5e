within Pneumatic.Examples;
model PressureSensorExample "The pressure of a vessel that is filled"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  Orifice orifice(C = 0.5e-8);
  Volume vessel(V = 1e-3);
  PressureSensor sensor;
equation
  connect(supply.port, orifice.port_a);
  connect(orifice.port_b, vessel.port);
  connect(sensor.port, vessel.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end PressureSensorExample;
