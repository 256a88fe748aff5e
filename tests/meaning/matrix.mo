//! x[1](0.17) = 1.17
//! x[1](0.63) = 1.63
//! x[2](0.89) = 2
//! y[1](0.17) = 5.17
//! y[1](0.63) = 5.63
//! d(0.89) = 6
//! T[1,2](0.89) = 3
//! K[2,1](0.17) = 0.51
//! K[2,1](0.63) = 1.89
//! cc[3,1](0.89) = 5
//! s[2](0.17) = 0.34
//! s[2](0.63) = 1.26
//! dt(0.17) = 1.0289
//! dt(0.63) = 1.3969
//! tr(0.89) = 15
//! P[1,1](0.89) = 7
//! P[2,2](0.89) = 22
//! mn(0.89) = 1
model M
  parameter Real A[2, 2] = {{1, 2}, {3, 4}};
  Real x[2];
  Real y[2] = A*{1 + time, 2} - {0, 3*time};
  Real d = {1, 2}*{2, 2};
  Real T[2, 2] = transpose(A);
  Real K[2, 2] = A*time;
  Real cc[3, 2] = cat(1, A, [5, 6]);
  Real s[2] = {1, 2}*time;
  Real rot[2, 2] = [time, -1; 1, time];
  Real dt = rot[1, 1]*rot[2, 2] - rot[1, 2]*rot[2, 1];
  Real tr = sum(A[i, i] for i in 1:2) + sum(sum(A[i, j] for j in 1:2) for i in 1:2);
  Real P[2, 2] = A^2;
  Real mn = min(A) + (min([3, 1; 2, 9]) - 1);
equation
  A*x = {(1 + time) + 4, 3*(1 + time) + 8};
end M;
