within Hydraulic.Examples;
model PilotedValve43Example "Pilot pressures over damping orifices move the spool; an orifice joins A to B"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 100e5);
  Tank tank;
  PilotedValve43 valve(q_nom = 5e-4);
  Orifice load(A = 5e-6);
  PressureSource pilot_X(useInput = true);
  PressureSource pilot_Y(useInput = true);
  Orifice damping_X(A = 0.8e-6);
  Orifice damping_Y(A = 0.8e-6);
  Signal.TimeTable lever_X(table = [0, 1e5; 0.1, 1e5; 0.15, 15e5; 0.6, 15e5; 0.65, 1e5; 1, 1e5]);
  Signal.TimeTable lever_Y(table = [0, 1e5; 0.8, 1e5; 0.82, 30e5; 1.2, 30e5; 1.22, 1e5; 1.6, 1e5]);
equation
  connect(source.port, valve.port_P);
  connect(tank.port, valve.port_T);
  connect(valve.port_A, load.port_a);
  connect(load.port_b, valve.port_B);
  connect(lever_X.y, pilot_X.p_in);
  connect(lever_Y.y, pilot_Y.p_in);
  connect(pilot_X.port, damping_X.port_a);
  connect(damping_X.port_b, valve.port_X);
  connect(pilot_Y.port, damping_Y.port_a);
  connect(damping_Y.port_b, valve.port_Y);
  annotation(experiment(StartTime = 0, StopTime = 1.6, Interval = 0.004, Tolerance = 1e-6));
end PilotedValve43Example;
