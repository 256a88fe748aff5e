model Shaft "A shaft turned by a torque"
  parameter Real J(unit = "kg.m2") = 0.1, k(unit = "N.m.s/rad") = 0.5;
  input Real T(start = 10, unit = "N.m");
  Real phi(start = 0, fixed = true, unit = "rad"), w(start = 0, fixed = true, unit = "rad/s");
equation
  der(phi) = w;
  J*der(w) = T - k*w;
end Shaft;
