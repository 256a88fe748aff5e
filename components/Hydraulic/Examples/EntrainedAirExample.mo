within Hydraulic.Examples;
model EntrainedAirExample "A cylinder is pressed, held and let go through a line: air dissolves in every chamber and cell"
  inner Oil.ISOVG46 oil(x_u = 0.6) "Oil with bubbles";
  PressureSource source(useInput = true);
  Signal.TimeTable pressure(table = [0, 2e5; 1, 2e5; 1.2, 60e5; 20, 60e5; 20.2, 2e5; 30, 2e5]);
  Line line(L = 2, d = 1e-2, n = 2, p_start = 2e5, redeclare model Air = EntrainedAir.Dissolving);
  Cylinder cylinder(A_1 = 1e-3, A_2 = 1e-3, p_1_start = 2e5, p_2_start = 2e5, redeclare model Air = EntrainedAir.Dissolving(tau_d = 5));
  Plug plug;
  Mechanical.Translational.Fixed wall(s0 = 0.05);
  Mechanical.Translational.Spring spring(c = 1e6);
equation
  connect(pressure.y, source.p_in);
  connect(source.port, line.port_a);
  connect(line.port_b, cylinder.port_1);
  connect(cylinder.port_2, plug.port);
  connect(cylinder.flange, spring.flange_a);
  connect(spring.flange_b, wall.flange);
  annotation(experiment(StartTime = 0, StopTime = 30, Interval = 0.06, Tolerance = 1e-6));
end EntrainedAirExample;
