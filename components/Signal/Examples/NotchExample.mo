within Signal.Examples;
model NotchExample "A slow sine passes, that of the notch does not, one is damped in part"
  Sine slow(f = 1);
  Sine fast(f = 20);
  Add both;
  Notch notch(w = 40*Modelica.Constants.pi, D = 0.3);
  Notch flat(w = 40*Modelica.Constants.pi, D = 0.3, depth = 0.25);
equation
  connect(slow.y, both.u1);
  connect(fast.y, both.u2);
  connect(both.y, notch.u);
  connect(fast.y, flat.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.001, Tolerance = 1e-6));
end NotchExample;
