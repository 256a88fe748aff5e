within Signal;
block StateSpace "Linear system in state space form"
  parameter Real A[:, :] = [-1] "System matrix";
  parameter Real B[:, :] = [1] "Input matrix";
  parameter Real C[:, :] = [1] "Output matrix";
  parameter Real D[:, :] = zeros(size(C, 1), size(B, 2)) "Feed through";
  parameter Real x_start[size(A, 1)] = zeros(size(A, 1)) "States at the start";
  Interfaces.RealInput u[size(B, 2)] "Inputs";
  Interfaces.RealOutput y[size(C, 1)] "Outputs";
  Real x[size(A, 1)](start = x_start, each fixed = true) "States";
equation
  assert(size(A, 1) == size(A, 2), "The system matrix A must be square");
  assert(size(B, 1) == size(A, 1) and size(C, 2) == size(A, 1), "B must have as many rows, C as many columns as A");
  der(x) = A*x + B*u;
  y = C*x + D*u;
  annotation(Documentation(info = "<html><p><code>dx/dt = A x + B u</code>, <code>y = C x + D u</code>.</p></html>"));
end StateSpace;
