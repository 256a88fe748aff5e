within Hydraulic.Examples;
model ReservoirExample "A differential cylinder's oil leaves a small sealed reservoir and returns"
  inner Oil.ISOVG46 oil "Oil";
  Reservoir reservoir(A = 0.02, h_max = 0.3, h_start = 0.2, closed = true);
  FlowSource cylinder(useInput = true);
  Signal.Sine course(amplitude = -1e-3, f = 0.2);
equation
  connect(course.y, cylinder.q_in);
  connect(cylinder.port, reservoir.port);
  annotation(experiment(StartTime = 0, StopTime = 10, Interval = 0.02, Tolerance = 1e-6));
end ReservoirExample;
