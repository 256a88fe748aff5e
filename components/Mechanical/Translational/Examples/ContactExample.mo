within Mechanical.Translational.Examples;
model ContactExample "A ball bounces on the ground; two bodies meet; one hits faster than the others"
  Fixed ground;
  Contact floor(c = 1e6, alpha = 0.1, useHeatPort = true);
  Mass ball(m = 0.5, s(start = 0.2));
  Gravity weight(m = 0.5);
  Thermal.HeatCapacitor warm(C = 1);
  Mass left(m = 1, v(start = 1));
  Contact between(c = 1e6, alpha = 0.1);
  Mass right(m = 2, s(start = 0.1));
  Contact wall(c = 1e6, alpha = 0.1, n = 1);
  Mass fast(m = 1, s(start = 0.1), v(start = -4));
equation
  connect(ground.flange, floor.flange_a);
  connect(floor.flange_b, ball.flange_a);
  connect(ball.flange_b, weight.flange);
  connect(floor.heatPort, warm.port);
  connect(left.flange_b, between.flange_a);
  connect(between.flange_b, right.flange_a);
  connect(ground.flange, wall.flange_a);
  connect(wall.flange_b, fast.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.0005, Tolerance = 1e-7));
end ContactExample;
