within Mechanical.Rotational.Examples;
model EndStopsExample "A lever swings to and fro between its stops"
  Signal.Sine sine(amplitude = 5, f = 0.5);
  Torque motor;
  Inertia lever(J = 0.5);
  EndStops stops(phi_min = -0.5, phi_max = 0.5);
equation
  connect(sine.y, motor.tau);
  connect(motor.flange, lever.flange_a);
  connect(lever.flange_b, stops.flange);
  annotation(experiment(StartTime = 0, StopTime = 4, Interval = 0.005, Tolerance = 1e-6));
end EndStopsExample;
