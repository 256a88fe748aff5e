within Mechanical.Rotational.Examples;
model WinchExample "A load is lifted off the ground, and set down again until the rope is slack"
  Signal.TimeTable speed(table = [0, 0; 0.5, 1; 4, 1; 5, -1; 9, -1; 9.5, 0]);
  Speed motor;
  Winch winch(n = 10, turns_start = 12, c = 2e5, d = 2e3, s_0 = 0.1, useHeatPort = true);
  Translational.Mass load(m = 500);
  Translational.Gravity weight(m = 500, slope = -Modelica.Constants.pi/2);
  Translational.EndStops ground(s_min = -100, s_max = 0, k = 1e6, c = 1e7);
  Thermal.HeatCapacitor rope(C = 1e3);
equation
  connect(speed.y, motor.w_ref);
  connect(motor.flange, winch.flangeR);
  connect(winch.flangeT, load.flange_a);
  connect(load.flange_b, weight.flange);
  connect(load.flange_b, ground.flange);
  connect(winch.heatPort, rope.port);
  annotation(experiment(StartTime = 0, StopTime = 10, Interval = 0.01, Tolerance = 1e-6));
end WinchExample;
