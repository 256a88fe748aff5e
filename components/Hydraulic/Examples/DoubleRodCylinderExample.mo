within Hydraulic.Examples;
model DoubleRodCylinderExample "A servo axis to and fro: the same speed both ways"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 150e5);
  Tank tank;
  Valve43 valve(q_nom = 2e-4);
  DoubleRodCylinder cylinder(A_1 = 10e-4, stroke = 0.4, s_start = 0.2, p_1_start = 75e5, p_2_start = 75e5);
  Mechanical.Translational.Mass load(m = 100, s(start = 0.2, fixed = false), v(fixed = false));
  Mechanical.Translational.ConstantForce force(f_constant = -1000) "On the other rod";
  Signal.TimeTable command(table = [0, 0; 0.1, 0; 0.15, 0.5; 0.5, 0.5; 0.55, -0.5; 1.1, -0.5; 1.15, 0; 1.3, 0]);
equation
  connect(source.port, valve.port_P);
  connect(valve.port_T, tank.port);
  connect(valve.port_A, cylinder.port_1);
  connect(valve.port_B, cylinder.port_2);
  connect(cylinder.flange, load.flange_a);
  connect(cylinder.flange_2, force.flange);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 1.3, Interval = 0.004, Tolerance = 1e-6));
end DoubleRodCylinderExample;
