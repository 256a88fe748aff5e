within Signal;
block Sum "Weighted sum of a vector of signals"
  parameter Integer n(min = 1) = 1 "Number of inputs";
  parameter Real k[n] = ones(n) "Weights";
  Interfaces.RealInput u[n] "Inputs";
  Interfaces.RealOutput y "Output";
equation
  y = k*u;
  annotation(Documentation(info = "<html><p>The sum of all inputs with their gains.</p></html>"));
end Sum;
