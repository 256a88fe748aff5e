within Pneumatic.Examples;
model SingleActingCylinderExample "A single-acting cylinder clamps and is returned by its spring"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  Atmosphere exhaust;
  Valve32 valve(C_max = 0.2e-8);
  SingleActingCylinder cylinder;
  Mechanical.Translational.ConstantForce load(f_constant = -10);
  Signal.Trapezoid command(rising = 1e-3, holding = 0.5, falling = 1e-3, startTime = 0.1);
equation
  connect(supply.port, valve.port_1);
  connect(valve.port_2, cylinder.port);
  connect(valve.port_3, exhaust.port);
  connect(cylinder.flange, load.flange);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 1.5, Interval = 0.003, Tolerance = 1e-6));
end SingleActingCylinderExample;
