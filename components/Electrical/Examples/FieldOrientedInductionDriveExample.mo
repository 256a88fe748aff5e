within Electrical.Examples;
model FieldOrientedInductionDriveExample "Run up, load step and reversal, with the speed measured, observed, and observed with a wrong rotor resistance"
  Drives.FieldOrientedInductionDrive measured, observed(sensorless = true), detuned(sensorless = true, k_Rr = 1.5);
  Mechanical.Rotational.Inertia rotor[3](each J = 0.4);
  Mechanical.Rotational.Torque load[3];
  Signal.Trapezoid speed(amplitude = 250, rising = 1, holding = 2, falling = 1.5, offset = -100, startTime = 0.5);
  Signal.Step torque(height = -100, startTime = 2);
equation
  connect(speed.y, measured.w_ref);
  connect(speed.y, observed.w_ref);
  connect(speed.y, detuned.w_ref);
  connect(measured.flange, rotor[1].flange_a);
  connect(observed.flange, rotor[2].flange_a);
  connect(detuned.flange, rotor[3].flange_a);
  for k in 1:3 loop
    connect(torque.y, load[k].tau);
    connect(load[k].flange, rotor[k].flange_b);
  end for;
  annotation(experiment(StartTime = 0, StopTime = 6, Interval = 0.005, Tolerance = 1e-6));
end FieldOrientedInductionDriveExample;
