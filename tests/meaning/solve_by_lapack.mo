//! x(1) = 1
//! y(1) = 2
//! slope(1) = 2
// linear equations and least squares as the Modelica Standard Library calls them
model M
  function solve
    input Real A[:, size(A, 1)];
    input Real b[size(A, 1)];
    output Real x[size(A, 1)] = b;
    output Integer info;
  protected
    Integer n = size(A, 1);
    Integer nrhs = 1;
    Real Awork[size(A, 1), size(A, 1)] = A;
    Integer lda = max(1, size(A, 1));
    Integer ldb = max(1, size(b, 1));
    Integer ipiv[size(A, 1)];
  external "FORTRAN 77" dgesv(n, nrhs, Awork, lda, ipiv, x, ldb, info);
  end solve;
  function fit
    input Real A[:, :];
    input Real b[size(A, 1)];
    input Real rcond = 0.0;
    output Real x[max(size(A, 1), size(A, 2))] = cat(1, b, zeros(max(nrow, ncol) - nrow));
    output Integer info;
    output Integer rank;
  protected
    Integer nrow = size(A, 1);
    Integer ncol = size(A, 2);
    Integer nrhs = 1;
    Integer nx = max(nrow, ncol);
    Integer lwork = 20;
    Real work[20];
    Real Awork[size(A, 1), size(A, 2)] = A;
    Integer jpvt[size(A, 2)] = zeros(ncol);
  external "FORTRAN 77" dgelsy(nrow, ncol, nrhs, Awork, nrow, x, nx, jpvt, rcond, rank, work, lwork, info);
  end fit;
  parameter Real c[3] = fit([0, 1; 1, 1; 2, 1], {1, 3, 5});
  Real v[2](start = {1, 2});
  Real x = v[1];
  Real y = v[2];
  Real slope = c[1]*time;
equation
  v = solve([2, time; 1, 3], {4*time, 7});
end M;
