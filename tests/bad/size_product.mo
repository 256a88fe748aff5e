//! E211 at 6: "3"
model M
  parameter Real A[2, 3] = [1, 2, 3; 4, 5, 6];
  Real x[2];
equation
  x = A*{1, 2};
end M;
