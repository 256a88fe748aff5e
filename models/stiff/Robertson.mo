model Robertson "Robertson's chemical reaction, index 1"
  parameter Real k_1(unit = "1/s") = 0.04 "A to B";
  parameter Real k_2(unit = "1/s") = 3e7 "B and B to C and B";
  parameter Real k_3(unit = "1/s") = 1e4 "B and C to A and C";
  Real y_1(start = 1, fixed = true) "Share of A";
  Real y_2(start = 0, fixed = true, nominal = 1e-6) "Share of B";
  Real y_3 "Share of C";
equation
  der(y_1) = -k_1*y_1 + k_3*y_2*y_3;
  der(y_2) = k_1*y_1 - k_3*y_2*y_3 - k_2*y_2^2;
  y_1 + y_2 + y_3 = 1;
  annotation(
    experiment(StartTime = 0, StopTime = 40, Interval = 0.4, Tolerance = 1e-6),
    Documentation(info = "<html><p>Published: at 40 s y = (0.7158, 9.185e-6, 0.2842); at 1e11 s
y = (0.2083340149701255e-7, 0.8333360770334713e-13, 0.9999999791665050). Source: H. H. Robertson 1966; values from E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, and the Test Set for IVP Solvers.</p></html>"));
end Robertson;
