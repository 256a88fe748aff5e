within Mechanical.Translational.Examples;
model LeverArmExample "A pedal pushed to and fro against a spring: exact, and for small angles"
  Signal.Sine sine(amplitude = 20, f = 1);
  Rotational.Torque foot;
  Rotational.Inertia pedal(J = 0.02);
  LeverArm arm(l = 0.2);
  SpringDamper spring(c = 1000, d = 20);
  Rotational.Torque foot2;
  Rotational.Inertia pedal2(J = 0.02);
  LeverArm arm2(l = 0.2, exact = false);
  SpringDamper spring2(c = 1000, d = 20);
  Fixed housing;
equation
  connect(sine.y, foot.tau);
  connect(foot.flange, pedal.flange_a);
  connect(pedal.flange_b, arm.flangeR);
  connect(arm.flangeT, spring.flange_a);
  connect(spring.flange_b, housing.flange);
  connect(sine.y, foot2.tau);
  connect(foot2.flange, pedal2.flange_a);
  connect(pedal2.flange_b, arm2.flangeR);
  connect(arm2.flangeT, spring2.flange_a);
  connect(spring2.flange_b, housing.flange);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.005, Tolerance = 1e-6));
end LeverArmExample;
