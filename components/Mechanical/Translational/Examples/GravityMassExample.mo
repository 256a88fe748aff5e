within Mechanical.Translational.Examples;
model GravityMassExample "Thrown upwards, let go on an incline, level, and held by a spring"
  GravityMass thrown(m = 2, mass(v(start = 5)));
  GravityMass slide(m = 3, slope = Modelica.Constants.pi/6);
  GravityMass level(m = 3, slope = 0, mass(v(start = 1)));
  GravityMass hung(m = 10, slope = -Modelica.Constants.pi/2);
  Spring spring(c = 1000);
  Fixed ceiling;
equation
  connect(ceiling.flange, spring.flange_a);
  connect(spring.flange_b, hung.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.005, Tolerance = 1e-6));
end GravityMassExample;
