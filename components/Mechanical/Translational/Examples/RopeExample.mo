within Mechanical.Translational.Examples;
model RopeExample "A weight falls into a rope and bounces until it hangs"
  Fixed ceiling;
  Rope rope(c = 1e4, d = 60, l = 1, useHeatPort = true);
  Mass load(m = 10, s(start = 0.5));
  Gravity weight(m = 10, slope = -Modelica.Constants.pi/2);
  Thermal.HeatCapacitor strands(C = 100);
equation
  connect(ceiling.flange, rope.flange_a);
  connect(rope.flange_b, load.flange_a);
  connect(load.flange_b, weight.flange);
  connect(rope.heatPort, strands.port);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.005, Tolerance = 1e-6));
end RopeExample;
