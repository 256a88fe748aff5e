//! y(0) = 11
//! n(0) = 2
block M "A matrix says that it is square, as StateSpace of the Modelica Standard Library does"
  parameter Real A[:, size(A, 1)] = [1, 2; 3, 5];
  parameter Real B[size(A, 1), :] = [0; 0];
  Real y = sum(A);
  Real n = size(A, 2)*size(B, 2);
end M;
