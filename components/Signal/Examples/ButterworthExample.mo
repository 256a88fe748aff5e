within Signal.Examples;
model ButterworthExample "Fourth order at 100 Hz, a chirp from 10 to 400 Hz"
  Chirp chirp(f_1 = 10, f_2 = 400, duration = 1);
  Butterworth filter(f_c = 100, sections = 2);
equation
  connect(chirp.y, filter.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 5e-4, Tolerance = 1e-6));
end ButterworthExample;
