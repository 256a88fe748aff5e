within Hydraulic.Examples;
model MixedFrictionExample "A pump speeds up from rest under pressure: its films form, and what leaks goes to the case"
  inner Oil.ISOVG46 oil "Oil";
  AxialPistonMachine pump(useCasePort = true, orificeFed = true, drag = 1, redeclare function pistonShare = MixedFriction.stribeck, redeclare function plateShare = MixedFriction.stribeck(Sc_0 = 2e-7));
  Signal.Ramp speed(height = 150, duration = 1);
  Mechanical.Rotational.Speed drive;
  PressureSource high(p = 150e5);
  Tank tank;
  Volume housing(V = 1e-3) "Housing of the pump";
  LaminarGap drain(G = 1e-9) "Drain line";
equation
  connect(speed.y, drive.w_ref);
  connect(drive.flange, pump.flange);
  connect(pump.port_a, high.port);
  connect(pump.port_b, tank.port);
  connect(pump.port_case, housing.port);
  connect(housing.port, drain.port_a);
  connect(drain.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1.2, Interval = 0.002, Tolerance = 1e-6));
end MixedFrictionExample;
