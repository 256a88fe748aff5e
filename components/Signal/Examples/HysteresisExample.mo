within Signal.Examples;
model HysteresisExample "A switching controller"
  Hysteresis switch1(uLow = 0.4, uHigh = 0.6);
  BooleanToReal valve(realTrue = 0, realFalse = 1);
  FirstOrder plant(T = 0.2);
equation
  connect(plant.y, switch1.u);
  connect(switch1.y, valve.u);
  connect(valve.y, plant.u);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end HysteresisExample;
