within Mechanical.Rotational.Examples;
model DifferentialExample "An axle on two grounds: the left wheel drags more; the drive turns back after a while"
  Signal.Sine sine(amplitude = 20, f = 0.25);
  Torque motor;
  Inertia shaft(J = 0.02);
  Differential axle(ratio = 4);
  Inertia wheelLeft(J = 0.8);
  Inertia wheelRight(J = 0.8);
  Damper dragLeft(d = 2);
  Damper dragRight(d = 0.5);
  Fixed ground;
equation
  connect(sine.y, motor.tau);
  connect(motor.flange, shaft.flange_a);
  connect(shaft.flange_b, axle.flange_a);
  connect(axle.left, wheelLeft.flange_a);
  connect(axle.right, wheelRight.flange_a);
  connect(wheelLeft.flange_b, dragLeft.flange_a);
  connect(wheelRight.flange_b, dragRight.flange_a);
  connect(dragLeft.flange_b, ground.flange);
  connect(dragRight.flange_b, ground.flange);
  annotation(experiment(StartTime = 0, StopTime = 8, Interval = 0.01, Tolerance = 1e-6));
end DifferentialExample;
