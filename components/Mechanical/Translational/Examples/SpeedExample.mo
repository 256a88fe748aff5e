within Mechanical.Translational.Examples;
model SpeedExample "A flange led with a given speed"
  Signal.Trapezoid command(amplitude = 1);
  Speed guide;
  SpringDamper spring(c = 100, d = 1);
  Mass mass(m = 1);
equation
  connect(command.y, guide.v_ref);
  connect(guide.flange, spring.flange_a);
  connect(spring.flange_b, mass.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end SpeedExample;
