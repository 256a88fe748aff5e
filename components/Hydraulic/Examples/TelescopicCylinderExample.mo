within Hydraulic.Examples;
model TelescopicCylinderExample "A tipper is raised stage after stage and comes down under its load"
  inner Oil.ISOVG46 oil "Oil";
  FlowSource pump(useInput = true);
  TelescopicCylinder cylinder(stroke = {0.5, 0.5, 0.5}, p_start = 18e5);
  ReliefValve relief(p_set = 150e5, q_nom = 1e-3);
  Tank tank;
  VariableOrifice lowering(A_max = 2e-5);
  Mechanical.Translational.ConstantForce load(f_constant = -20000);
  Signal.Trapezoid delivery(amplitude = 1e-3, rising = 0.2, holding = 10.5, falling = 0.2, startTime = 0.2);
  Signal.Ramp opening(duration = 0.2, startTime = 12);
equation
  connect(delivery.y, pump.q_in);
  connect(pump.port, cylinder.port);
  connect(cylinder.port, relief.port_a);
  connect(relief.port_b, tank.port);
  connect(cylinder.port, lowering.port_a);
  connect(lowering.port_b, tank.port);
  connect(opening.y, lowering.u);
  connect(load.flange, cylinder.flange);
  annotation(experiment(StartTime = 0, StopTime = 30, Interval = 0.05, Tolerance = 1e-6));
end TelescopicCylinderExample;
