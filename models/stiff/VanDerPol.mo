model VanDerPol "Relaxation oscillator with a small parameter"
  parameter Real epsilon(min = 0) = 1e-6 "Size of the fast equation";
  Real y_1(start = 2, fixed = true);
  Real y_2(start = 0, fixed = true);
equation
  der(y_1) = y_2;
  epsilon*der(y_2) = (1 - y_1^2)*y_2 - y_1;
  annotation(
    experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6),
    Documentation(info = "<html><p>Source: B. van der Pol 1926; Test Set for IVP Solvers, problem VDPOL in the scaling of E. Hairer and G. Wanner, with the published values at 2.</p></html>"));
end VanDerPol;
