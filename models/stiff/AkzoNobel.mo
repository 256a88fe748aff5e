model AkzoNobel "Chemical Akzo Nobel problem, index 1"
  constant Real k_1 = 18.7;
  constant Real k_2 = 0.58;
  constant Real k_3 = 0.09;
  constant Real k_4 = 0.42;
  constant Real K = 34.4;
  constant Real klA = 3.3;
  constant Real K_s = 115.83;
  constant Real p_CO2 = 0.9;
  constant Real H = 737;
  Real y_1(start = 0.444, fixed = true);
  Real y_2(start = 0.00123, fixed = true, nominal = 1e-3);
  Real y_3(start = 0, fixed = true);
  Real y_4(start = 0.007, fixed = true, nominal = 1e-3);
  Real y_5(start = 0, fixed = true, nominal = 1e-2);
  Real y_6(start = 0.36, nominal = 1e-2);
protected
  Real r_1, r_2, r_3, r_4, r_5, F_in;
equation
  r_1 = k_1*y_1^4*sqrt(y_2);
  r_2 = k_2*y_3*y_4;
  r_3 = k_2/K*y_1*y_5;
  r_4 = k_3*y_1*y_4^2;
  r_5 = k_4*y_6^2*sqrt(y_2);
  F_in = klA*(p_CO2/H - y_2);
  der(y_1) = -2*r_1 + r_2 - r_3 - r_4;
  der(y_2) = -0.5*r_1 - r_4 - 0.5*r_5 + F_in;
  der(y_3) = r_1 - r_2 + r_3;
  der(y_4) = -r_2 + r_3 - 2*r_4;
  der(y_5) = r_2 - r_3 + r_5;
  0 = K_s*y_1*y_4 - y_6;
  annotation(
    experiment(StartTime = 0, StopTime = 180, Interval = 0.9, Tolerance = 1e-6),
    Documentation(info = "<html><p>Published at 180 (minutes, the unit of time of the model): y = (0.1150794920661702, 0.1203831471567715e-2, 0.1611562887407974, 0.3656156421249283e-3, 0.1708010885264404e-1, 0.4873531310307455e-2).
Source: W. J. H. Stortelder 1998; Test Set for IVP Solvers, problem CHEMAKZO.</p></html>"));
end AkzoNobel;
