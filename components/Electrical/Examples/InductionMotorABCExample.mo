within Electrical.Examples;
model InductionMotorABCExample "Start with a soft starter, then the fuse of a phase blows: the motor goes on with two, at twice the frequency in its torque"
  ThreePhaseVoltage line(U = 460/sqrt(3), f = 60, useInput = true);
  Ground ground;
  Switch fuse[3](each R_on = 1e-3, each G_off = 1e-3);
  Machines.InductionMotorABC motor;
  Mechanical.Rotational.Inertia rotor(J = 0.4);
  Mechanical.Rotational.QuadraticLoad load(tau_nominal = 100, w_nominal = 188);
  Signal.Ramp softStart(offset = 0.5, height = 0.5, duration = 0.8);
  Signal.BooleanStep blows(startTime = 1.5, startValue = true);
equation
  connect(softStart.y, line.scale);
  connect(line.neutral, ground.p);
  connect(line.a, fuse[1].p);
  connect(line.b, fuse[2].p);
  connect(line.c, fuse[3].p);
  connect(fuse[1].n, motor.U1);
  connect(fuse[2].n, motor.V1);
  connect(fuse[3].n, motor.W1);
  fuse[1].closed = true;
  fuse[2].closed = true;
  connect(blows.y, fuse[3].closed);
  connect(motor.U2, motor.V2);
  connect(motor.V2, motor.W2);
  connect(motor.flange, rotor.flange_a);
  connect(rotor.flange_b, load.flange);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.0005, Tolerance = 1e-6));
end InductionMotorABCExample;
