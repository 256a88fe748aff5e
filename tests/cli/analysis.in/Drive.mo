model Drive "Two shafts with a spring between them, turned by a torque"
  parameter Real k(unit = "N.m.s/rad") = 0.5 "Drag of each";
  parameter Real c(unit = "N.m/rad") = 1000 "Stiffness";
  parameter Real d(unit = "N.m.s/rad") = 2 "Damping";
  parameter Real J[2](each unit = "kg.m2") = {0.1, 0.3};
  input Real T(start = 10, unit = "N.m");
  Real phi_1(start = 0, fixed = true, unit = "rad"), phi_2(start = 0, fixed = true, unit = "rad");
  Real w_1(start = 0, fixed = true, unit = "rad/s"), w_2(start = 0, fixed = true, unit = "rad/s");
  Real spring(unit = "N.m");
equation
  der(phi_1) = w_1;
  der(phi_2) = w_2;
  spring = c*(phi_1 - phi_2) + d*(w_1 - w_2);
  J[1]*der(w_1) = T - k*w_1 - spring;
  J[2]*der(w_2) = spring - k*w_2;
end Drive;
