within Mechanical.Rotational.Examples;
model LossyPlanetaryExample "Two drives on sun and ring, the carrier turns a load; the oil takes the losses"
  Signal.Sine sine1(amplitude = 2, f = 1);
  Signal.Sine sine2(amplitude = 5, f = 0.4);
  Torque drive1;
  Torque drive2;
  Inertia sun(J = 0.01);
  Inertia ring(J = 0.05);
  LossyPlanetary gear(ratio = 3, eta_sun = 0.95, eta_ring = 0.95, P_0 = 0.1, useHeatPort = true);
  Inertia load(J = 0.2);
  Damper friction(d = 0.5);
  Fixed housing;
  Thermal.HeatCapacitor oil(C = 100);
equation
  connect(sine1.y, drive1.tau);
  connect(sine2.y, drive2.tau);
  connect(drive1.flange, sun.flange_a);
  connect(drive2.flange, ring.flange_a);
  connect(sun.flange_b, gear.sun);
  connect(ring.flange_b, gear.ring);
  connect(gear.carrier, load.flange_a);
  connect(load.flange_b, friction.flange_a);
  connect(friction.flange_b, housing.flange);
  connect(gear.heatPort, oil.port);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end LossyPlanetaryExample;
