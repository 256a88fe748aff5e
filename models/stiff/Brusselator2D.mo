model Brusselator2D "Two substances that react and diffuse on a square whose edges meet"
  parameter Integer N = 32 "Grid points in each direction";
  constant Real alpha = 0.1 "Diffusion";
  Real u[N, N](start = {{22*(j - 1)/N*(1 - (j - 1)/N)^1.5 for j in 1:N} for i in 1:N}, each fixed = true);
  Real v[N, N](start = {{27*(i - 1)/N*(1 - (i - 1)/N)^1.5 for j in 1:N} for i in 1:N}, each fixed = true);
protected
  Real f[N, N] "What is fed in a disk, from a time on";
  final parameter Real d = alpha*N^2;
equation
  for i in 1:N, j in 1:N loop
    f[i, j] = if ((i - 1)/N - 0.3)^2 + ((j - 1)/N - 0.6)^2 <= 0.01 then (if time >= 1.1 then 5 else 0) else 0;
    der(u[i, j]) = 1 + u[i, j]^2*v[i, j] - 4.4*u[i, j] + f[i, j]
      + d*(u[mod(i, N) + 1, j] + u[mod(i - 2, N) + 1, j] + u[i, mod(j, N) + 1] + u[i, mod(j - 2, N) + 1] - 4*u[i, j]);
    der(v[i, j]) = 3.4*u[i, j] - u[i, j]^2*v[i, j]
      + d*(v[mod(i, N) + 1, j] + v[mod(i - 2, N) + 1, j] + v[i, mod(j, N) + 1] + v[i, mod(j - 2, N) + 1] - 4*v[i, j]);
  end for;
  annotation(
    experiment(StartTime = 0, StopTime = 11.5, Interval = 0.023, Tolerance = 1e-6),
    Documentation(info = "<html><p>Source: problem BRUSS-2D of E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, section IV.10. u[i, j] lies at x = (i - 1)/N, y = (j - 1)/N.</p></html>"));
end Brusselator2D;
