within Mechanical.Translational.Examples;
model BrakeExample "A sliding load is stopped, held, and let go again"
  Mass load(m = 50, v(start = 1));
  ConstantForce weight(f_constant = 200);
  Brake brake(fn_max = 3000, peak = 1.2);
  Signal.Trapezoid command(amplitude = 1, rising = 0.1, holding = 1, falling = 0.1, startTime = 0.2);
equation
  connect(weight.flange, load.flange_a);
  connect(load.flange_b, brake.flange_a);
  connect(command.y, brake.f_normalized);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.005, Tolerance = 1e-6));
end BrakeExample;
