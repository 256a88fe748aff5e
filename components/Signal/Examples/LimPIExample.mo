within Signal.Examples;
model LimPIExample "A loop with limited actuator"
  Step command(startTime = 0.1);
  LimPI control(k = 2, T_i = 0.1, yMax = 2);
  FirstOrder plant(T = 0.3);
equation
  connect(command.y, control.u_s);
  connect(plant.y, control.u_m);
  connect(control.y, plant.u);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end LimPIExample;
