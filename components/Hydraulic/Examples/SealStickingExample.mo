within Hydraulic.Examples;
model SealStickingExample "A cylinder lifts a load and holds it"
  inner Oil.ISOVG46 oil "Oil";
  FlowSource source_1(useInput = true);
  Tank tank;
  Cylinder cylinder(redeclare SealFriction.Sticking seal, s_start = 0.05, p_1_start = 2e5, p_2_start = 1.2e5);
  Orifice back(A = 2e-5);
  Signal.Trapezoid delivery(amplitude = 2e-4, rising = 0.05, holding = 0.6, falling = 0.05, startTime = 0.1);
  Mechanical.Translational.ConstantForce load(f_constant = -5000);
equation
  connect(delivery.y, source_1.q_in);
  connect(source_1.port, cylinder.port_1);
  connect(cylinder.port_2, back.port_a);
  connect(back.port_b, tank.port);
  connect(load.flange, cylinder.flange);
  annotation(experiment(StartTime = 0, StopTime = 1.5, Interval = 0.003, Tolerance = 1e-6));
end SealStickingExample;
