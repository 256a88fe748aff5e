within Mechanical.Translational.Examples;
model ConstantSpeedExample "A flange led with constant speed"
  ConstantSpeed guide(v_fixed = 1);
  SpringDamper spring(c = 100, d = 1);
  Mass mass(m = 1);
equation
  connect(guide.flange, spring.flange_a);
  connect(spring.flange_b, mass.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end ConstantSpeedExample;
