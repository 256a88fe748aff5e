within Mechanical.Rotational.Examples;
model DrumExample "Steady turning winds up three layers, then pays them out"
  Signal.TimeTable speed(table = [0, 0; 1, 20; 14, 20; 16, -20; 29, -20; 30, 0]);
  Speed motor;
  Drum drum(n = 10, layers = 5, turns_start = 2, d_rope = 0.02);
  Translational.Gravity weight(m = 100, slope = -Modelica.Constants.pi/2);
  Translational.Mass hook(m = 100);
equation
  connect(speed.y, motor.w_ref);
  connect(motor.flange, drum.flangeR);
  connect(drum.flangeT, hook.flange_a);
  connect(hook.flange_b, weight.flange);
  annotation(experiment(StartTime = 0, StopTime = 30, Interval = 0.02, Tolerance = 1e-6));
end DrumExample;
