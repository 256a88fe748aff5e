model Brusselator "Two substances that react and diffuse along a line"
  parameter Integer N = 500 "Grid points between the ends";
  constant Real A = 1;
  constant Real B = 3;
  constant Real alpha = 1/50 "Diffusion";
  Real u[N](start = {1 + sin(2*Modelica.Constants.pi*i/(N + 1)) for i in 1:N}, each fixed = true);
  Real v[N](each start = 3, each fixed = true);
protected
  final parameter Real d = alpha*(N + 1)^2;
equation
  for i in 1:N loop
    der(u[i]) = A + u[i]^2*v[i] - (B + 1)*u[i]
      + d*((if i == 1 then 1 else u[i - 1]) - 2*u[i] + (if i == N then 1 else u[i + 1]));
    der(v[i]) = B*u[i] - u[i]^2*v[i]
      + d*((if i == 1 then 3 else v[i - 1]) - 2*v[i] + (if i == N then 3 else v[i + 1]));
  end for;
  annotation(
    experiment(StartTime = 0, StopTime = 10, Interval = 0.02, Tolerance = 1e-6),
    Documentation(info = "<html><p>Source: I. Prigogine and R. Lefever 1968; problem BRUSS of E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, section IV.1.</p></html>"));
end Brusselator;
