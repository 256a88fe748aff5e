within Signal.Examples;
model MovingAverageExample "The mean of a sine over its period, of a pulse, and of a constant"
  Sine sine(f = 10, amplitude = 2);
  MovingAverage meanSine(T = 0.1);
  Pulse pulse(period = 0.4, width = 0.5);
  MovingAverage meanPulse(T = 0.1);
  Constant three(k = 3);
  MovingAverage meanThree(T = 0.1, u_start = 3);
equation
  connect(sine.y, meanSine.u);
  connect(pulse.y, meanPulse.u);
  connect(three.y, meanThree.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end MovingAverageExample;
