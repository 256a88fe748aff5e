model E5 "Pyrolysis, with concentrations over twenty decades"
  constant Real A = 7.89e-10;
  constant Real B = 1.1e7;
  constant Real C = 1.13e3;
  constant Real M = 1e6;
  Real y_1(start = 1.76e-3, fixed = true, nominal = 1e-20);
  Real y_2(start = 0, fixed = true, nominal = 1e-20);
  Real y_3(nominal = 1e-20);
  Real y_4(start = 0, fixed = true, nominal = 1e-20);
equation
  der(y_1) = -A*y_1 - B*y_1*y_3;
  der(y_2) = A*y_1 - M*C*y_2*y_3;
  der(y_4) = B*y_1*y_3 - C*y_4;
  y_3 = y_2 - y_4;
  annotation(
    experiment(StartTime = 0, StopTime = 1e13, Interval = 1e10, Tolerance = 1e-6),
    Documentation(info = "<html><p>Source: W. H. Enright, T. E. Hull and B. Lindberg 1975; Test Set for IVP Solvers, problem E5, with the published values at 1e13. The rate of the third species is the difference of those of the second and fourth; it is written as that, so that it has all its digits.</p></html>"));
end E5;
