//! run
//! E501: "holds only quantities that have memory"
model M
  Mechanical.Rotational.Torque drive;
  Signal.Sine sine(amplitude = 10);
  Mechanical.Rotational.Inertia mass(J = 1, phi(fixed = true), w(fixed = true));
  Mechanical.Rotational.ElastoBacklash play(b = 0.02, c = 1e3, d = 5, phi_rel(fixed = true));
  Mechanical.Rotational.Spring spring(c = 100);
  Mechanical.Rotational.Fixed wall;
equation
  connect(sine.y, drive.tau);
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, play.flange_a);
  connect(play.flange_b, spring.flange_a);
  connect(spring.flange_b, wall.flange);
end M;
