model Squeezer "Andrews' squeezing mechanism: seven bodies in three loops, driven by a constant torque (index 3)"
  constant Real m[7] = {0.04325, 0.00365, 0.02373, 0.00706, 0.0705, 0.00706, 0.05498} "Masses";
  constant Real I[7] = {2.194e-6, 4.41e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5} "Moments of inertia";
  constant Real x_a = -0.06934, y_a = -0.00227;
  constant Real x_b = -0.03635, y_b = 0.03273;
  constant Real x_c = 0.014, y_c = 0.072;
  constant Real d = 28e-3, da = 115e-4;
  constant Real e = 2e-2, ea = 1421e-5;
  constant Real zf = 2e-2, fa = 1421e-5;
  constant Real rr = 7e-3, ra = 92e-5;
  constant Real ss = 35e-3, sa = 1874e-5, sb = 1043e-5, sc = 18e-3, sd = 2e-2;
  constant Real zt = 4e-2, ta = 2308e-5, tb = 916e-5;
  constant Real u = 4e-2, ua = 1228e-5, ub = 449e-5;
  constant Real c_0 = 4530 "Stiffness of the spring";
  constant Real l_0 = 7785e-5 "Its length at rest";
  constant Real mom = 33e-3 "Driving torque";
  Real beta(start = -0.0617138900142764496358948458001, fixed = true, stateSelect = StateSelect.always) "Crank";
  Real theta(start = 0), gamma(start = 0.455279819163070380255912382449);
  Real phi(start = 0.222668390165885884674473185609), delta(start = 0.48736497954384255022559895353);
  Real Omega(start = -0.222668390165885884674473185609), epsilon(start = 1.23054744454982119249735015568);
  Real w[7](start = {0, 0, 0, 0, 0, 0, 0}, fixed = {true, false, false, false, false, false, false}, each nominal = 100,
    stateSelect = {StateSelect.always, StateSelect.default, StateSelect.default, StateSelect.default,
      StateSelect.default, StateSelect.default, StateSelect.default}) "Angular velocities, in the order of the angles";
  Real lambda[6](each nominal = 10) "Forces of the constraints";
protected
  constant Real e_m = e - ea;
  constant Real f_m = zf - fa;
  Real a[7](each nominal = 1e4) "Angular accelerations";
  Real xd, yd, l, force, f_x, f_y "Spring";
equation
  w[1] = der(beta);
  w[2] = der(theta);
  w[3] = der(gamma);
  w[4] = der(phi);
  w[5] = der(delta);
  w[6] = der(Omega);
  w[7] = der(epsilon);
  a = der(w);

  xd = sd*cos(gamma) + sc*sin(gamma) + x_b;
  yd = sd*sin(gamma) - sc*cos(gamma) + y_b;
  l = sqrt((xd - x_c)^2 + (yd - y_c)^2);
  force = -c_0*(l - l_0)/l;
  f_x = force*(xd - x_c);
  f_y = force*(yd - y_c);

  (m[1]*ra^2 + m[2]*(rr^2 - 2*da*rr*cos(theta) + da^2) + I[1] + I[2])*a[1]
    + (m[2]*(da^2 - da*rr*cos(theta)) + I[2])*a[2]
    - mom + m[2]*da*rr*w[2]*(w[2] + 2*w[1])*sin(theta)
    + (-rr*sin(beta) + d*sin(beta + theta))*(lambda[1] + lambda[3] + lambda[5])
    + (rr*cos(beta) - d*cos(beta + theta))*(lambda[2] + lambda[4] + lambda[6]) = 0;
  (m[2]*(da^2 - da*rr*cos(theta)) + I[2])*a[1] + (m[2]*da^2 + I[2])*a[2]
    - m[2]*da*rr*w[1]^2*sin(theta)
    + d*sin(beta + theta)*(lambda[1] + lambda[3] + lambda[5])
    - d*cos(beta + theta)*(lambda[2] + lambda[4] + lambda[6]) = 0;
  (m[3]*(sa^2 + sb^2) + I[3])*a[3]
    - f_x*(sc*cos(gamma) - sd*sin(gamma)) - f_y*(sd*cos(gamma) + sc*sin(gamma))
    - ss*cos(gamma)*lambda[1] - ss*sin(gamma)*lambda[2] = 0;
  (m[4]*e_m^2 + I[4])*a[4] + (m[4]*(e_m^2 + zt*e_m*sin(phi)) + I[4])*a[5]
    - m[4]*zt*e_m*w[5]^2*cos(phi)
    - e*cos(phi + delta)*lambda[3] - e*sin(phi + delta)*lambda[4] = 0;
  (m[4]*(e_m^2 + zt*e_m*sin(phi)) + I[4])*a[4]
    + (m[4]*(zt^2 + 2*zt*e_m*sin(phi) + e_m^2) + m[5]*(ta^2 + tb^2) + I[4] + I[5])*a[5]
    + m[4]*zt*e_m*w[4]*(w[4] + 2*w[5])*cos(phi)
    + (-e*cos(phi + delta) + zt*sin(delta))*lambda[3] + (-e*sin(phi + delta) - zt*cos(delta))*lambda[4] = 0;
  (m[6]*f_m^2 + I[6])*a[6] + (m[6]*(f_m^2 - u*f_m*sin(Omega)) + I[6])*a[7]
    + m[6]*u*f_m*w[7]^2*cos(Omega)
    + zf*sin(Omega + epsilon)*lambda[5] - zf*cos(Omega + epsilon)*lambda[6] = 0;
  (m[6]*(f_m^2 - u*f_m*sin(Omega)) + I[6])*a[6]
    + (m[6]*(f_m^2 - 2*u*f_m*sin(Omega) + u^2) + m[7]*(ua^2 + ub^2) + I[6] + I[7])*a[7]
    - m[6]*u*f_m*w[6]*(w[6] + 2*w[7])*cos(Omega)
    + (zf*sin(Omega + epsilon) - u*cos(epsilon))*lambda[5] + (-zf*cos(Omega + epsilon) - u*sin(epsilon))*lambda[6] = 0;

  rr*cos(beta) - d*cos(beta + theta) - ss*sin(gamma) - x_b = 0;
  rr*sin(beta) - d*sin(beta + theta) + ss*cos(gamma) - y_b = 0;
  rr*cos(beta) - d*cos(beta + theta) - e*sin(phi + delta) - zt*cos(delta) - x_a = 0;
  rr*sin(beta) - d*sin(beta + theta) + e*cos(phi + delta) - zt*sin(delta) - y_a = 0;
  rr*cos(beta) - d*cos(beta + theta) - zf*cos(Omega + epsilon) - u*sin(epsilon) - x_a = 0;
  rr*sin(beta) - d*sin(beta + theta) - zf*sin(Omega + epsilon) + u*cos(epsilon) - y_a = 0;
  annotation(
    experiment(StartTime = 0, StopTime = 0.03, Interval = 6e-5, Tolerance = 1e-6),
    Documentation(info = "<html><p>In SI units. Source: W. Schiehlen (ed.), Multibody Systems Handbook, 1990; E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, section VII.7; Test Set for IVP Solvers, problem ANDREWS, with the published values at 0.03. Crank angle and speed are the states, everything else follows from the loops.</p></html>"));
end Squeezer;
