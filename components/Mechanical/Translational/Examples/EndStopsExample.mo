within Mechanical.Translational.Examples;
model EndStopsExample "A mass flies between two stops"
  Mass mass(m = 1, v(start = 1), s(start = 0.05));
  EndStops stops(s_min = 0, s_max = 0.1, k = 1e5, c = 1e6, d_0 = 1e-4);
equation
  connect(mass.flange_b, stops.flange);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end EndStopsExample;
