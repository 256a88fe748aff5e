within Signal;
block PI "PI controller without limits: k (1 + 1/(T s))"
  extends Bases.OneToOne;
  parameter Real k = 1 "Gain";
  parameter SI.Time T(min = 1e-9) = 1 "Time of the integrator";
  parameter Real x_start = 0 "Integral part at the start";
  Real x(start = x_start, fixed = true) "Integral part";
equation
  assert(T > 0, "The time T must be positive");
  der(x) = k/T*u;
  y = k*u + x;
  annotation(Documentation(info = "<html><p><code>y = k (u + 1/T integral of u)</code>, without limits; with limits take <code>LimPI</code>.</p></html>"));
end PI;
