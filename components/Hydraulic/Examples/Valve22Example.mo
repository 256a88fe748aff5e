within Hydraulic.Examples;
model Valve22Example "A solenoid valve opens"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 100e5);
  Valve22 valve;
  Tank tank;
  Signal.Step step(startTime = 0.2);
equation
  connect(source.port, valve.port_a);
  connect(valve.port_b, tank.port);
  connect(step.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end Valve22Example;
