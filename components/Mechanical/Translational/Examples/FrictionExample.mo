within Mechanical.Translational.Examples;
model FrictionExample "Two of them coupled by dry friction, sticking and sliding"
  Signal.Sine sine(amplitude = 10, f = 1);
  Force drive;
  Mass mass(m = 1);
  Friction contact(f_c = 3, f_s = 4, v_s = 0.1);
  Mass load(m = 2);
  Fixed wall;
  SpringDamper spring(c = 50, d = 1);
equation
  connect(sine.y, drive.f);
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, contact.flange_a);
  connect(contact.flange_b, load.flange_a);
  connect(load.flange_b, spring.flange_a);
  connect(spring.flange_b, wall.flange);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end FrictionExample;
