within Hydraulic.Examples;
model SingleActingCylinderExample "A lifting cylinder, out under pressure and back under its spring"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Trapezoid delivery(amplitude = 1e-4, rising = 0.05, holding = 0.5, falling = 0.05, startTime = 0.1);
  FlowSource source(useInput = true);
  SingleActingCylinder cylinder(p_start = 4e5);
  Orifice bleed(A = 2e-6);
  Tank tank;
  Mechanical.Translational.ConstantForce load(f_constant = -100);
equation
  connect(delivery.y, source.q_in);
  connect(source.port, cylinder.port);
  connect(cylinder.port, bleed.port_a);
  connect(bleed.port_b, tank.port);
  connect(load.flange, cylinder.flange);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end SingleActingCylinderExample;
