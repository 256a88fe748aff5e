within Signal.Examples;
model PIDExample "A loop with limited actuator, the same with a limited rate, and a controller alone"
  Step command(startTime = 0.1);
  PID control(k = 4, T_i = 0.3, T_d = 0.05, T_t = 0.1, b = 0.8, yMax = 1.5);
  SecondOrder plant(w = 8, D = 0.7);
  PID gentle(k = 4, T_i = 0.3, T_d = 0.05, T_t = 0.1, b = 0.8, yMax = 1.5, limitRate = true, rateMax = 20);
  SecondOrder plant2(w = 8, D = 0.7);
  PID open(k = 2, T_i = 0.5, T_d = 0.2, T_f = 0.02, c = 1, yMax = 1000);
  Constant zero(k = 0);
equation
  connect(command.y, control.u_s);
  connect(plant.y, control.u_m);
  connect(control.y, plant.u);
  connect(command.y, gentle.u_s);
  connect(plant2.y, gentle.u_m);
  connect(gentle.y, plant2.u);
  connect(command.y, open.u_s);
  connect(zero.y, open.u_m);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.005, Tolerance = 1e-6));
end PIDExample;
