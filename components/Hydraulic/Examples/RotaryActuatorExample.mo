within Hydraulic.Examples;
model RotaryActuatorExample "A slewing drive from stop to stop"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 120e5);
  Tank tank;
  Valve43 valve(q_nom = 2e-4);
  RotaryActuator actuator(p_1_start = 30e5, p_2_start = 30e5);
  Mechanical.Rotational.Inertia load(J = 2, phi(fixed = false), w(fixed = false));
  Signal.TimeTable command(table = [0, 0; 0.1, 0; 0.2, 0.6; 2, 0.6; 2.1, -0.6; 5.4, -0.6; 5.5, 0; 6, 0]);
equation
  connect(source.port, valve.port_P);
  connect(valve.port_T, tank.port);
  connect(valve.port_A, actuator.port_1);
  connect(valve.port_B, actuator.port_2);
  connect(actuator.flange, load.flange_a);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 6, Interval = 0.01, Tolerance = 1e-6));
end RotaryActuatorExample;
