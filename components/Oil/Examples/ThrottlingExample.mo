within Oil.Examples;
model ThrottlingExample "How much oil warms when a throttle takes its pressure"
  inner Oil.ISOVG46 oil(thermal = true) "Oil";
  Signal.Ramp pressure(height = 350e5, offset = 1e5, duration = 1);
  Hydraulic.PressureSource source(useInput = true);
  Hydraulic.Orifice orifice(A = 1e-6);
  Hydraulic.TemperatureSensor behind;
  Hydraulic.FlowSensor line;
  Hydraulic.Tank tank;
equation
  connect(pressure.y, source.p_in);
  connect(source.port, orifice.port_a);
  connect(orifice.port_b, line.port_a);
  connect(line.port_b, tank.port);
  connect(behind.port, line.port_a);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end ThrottlingExample;
