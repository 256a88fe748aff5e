within Hydraulic.Examples;
model PressureReducerExample "A constant pressure for a consumer that grows"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 200e5);
  PressureReducer valve(p_set = 50e5, q_nom = 5e-4);
  Volume volume(V = 2e-4, p_start = 40e5);
  VariableOrifice load(A_max = 5e-6);
  Signal.Ramp ramp(height = 0.8, offset = 0.1, duration = 1);
  Tank tank;
equation
  connect(source.port, valve.port_a);
  connect(valve.port_b, volume.port);
  connect(volume.port, load.port_a);
  connect(load.port_b, tank.port);
  connect(ramp.y, load.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end PressureReducerExample;
