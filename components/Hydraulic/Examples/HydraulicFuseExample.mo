within Hydraulic.Examples;
model HydraulicFuseExample "A load comes down through a hose that breaks; feeding oil back opens the valve again"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource load(p = 100e5) "Pressure of the load";
  HydraulicFuse fuse(q_close = 4e-4);
  Volume hose(V = 2e-4, p_start = 100e5);
  VariableOrifice lowering(A_max = 2e-5);
  PressureSource line(useInput = true);
  Signal.TimeTable opening(table = [0, 0; 0.1, 0; 0.15, 0.1; 0.4, 0.1; 0.42, 1; 0.7, 1; 0.8, 0.1; 1.2, 0.1]);
  Signal.TimeTable pressure(table = [0, 1e5; 0.8, 1e5; 0.85, 120e5; 1, 120e5; 1.1, 50e5; 1.2, 50e5]);
equation
  connect(load.port, fuse.port_a);
  connect(fuse.port_b, hose.port);
  connect(hose.port, lowering.port_a);
  connect(lowering.port_b, line.port);
  connect(opening.y, lowering.u);
  connect(pressure.y, line.p_in);
  annotation(experiment(StartTime = 0, StopTime = 1.2, Interval = 0.002, Tolerance = 1e-6));
end HydraulicFuseExample;
