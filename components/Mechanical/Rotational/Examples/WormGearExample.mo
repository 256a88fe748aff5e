within Mechanical.Rotational.Examples;
model WormGearExample "A worm lifts a load, holds it without torque and lets it down"
  Signal.TimeTable course(table = [0, 0; 0.5, 0; 1, 20; 3, 20; 3.5, 0; 5, 0; 5.5, -20; 7, -20; 7.5, 0; 8, 0]);
  Torque motor;
  Inertia worm(J = 0.05);
  Damper drag(d = 0.05);
  Fixed housing;
  WormGear gear(gamma = 0.05, mu = 0.06);
  Inertia wheel(J = 2);
  ConstantTorque load(tau_constant = -200);
equation
  connect(course.y, motor.tau);
  connect(motor.flange, worm.flange_a);
  connect(worm.flange_b, gear.flange_a);
  connect(drag.flange_a, worm.flange_a);
  connect(drag.flange_b, housing.flange);
  connect(gear.flange_b, wheel.flange_a);
  connect(wheel.flange_b, load.flange);
  annotation(experiment(StartTime = 0, StopTime = 8, Interval = 0.016, Tolerance = 1e-6));
end WormGearExample;
