within Mechanical.Rotational.Examples;
model ClutchExample "A clutch starts a load and lets it go"
  Inertia mass(J = 1, w(start = 100));
  Clutch clutch(fn_max = 100, cgeo = 0.5);
  Inertia load(J = 2);
  Signal.Pulse engage(period = 10, width = 0.5, startTime = 1);
equation
  connect(engage.y, clutch.f_normalized);
  connect(mass.flange_b, clutch.flange_a);
  connect(clutch.flange_b, load.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 10, Interval = 0.02, Tolerance = 1e-6));
end ClutchExample;
