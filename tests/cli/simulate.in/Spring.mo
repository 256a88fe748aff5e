model Spring "A mass on a spring, pushed from outside"
  type Mode = enumeration(out, back);
  parameter Real m(unit = "kg") = 1;
  parameter Real c(unit = "N/m") = 10;
  parameter Mode first = Mode.out;
  input Real F(unit = "N");
  Real x(unit = "m", start = 0.1, fixed = true);
  Real v(unit = "m/s", start = 0, fixed = true);
  Boolean right = x > 0;
protected
  Real a(unit = "m/s2");
equation
  der(x) = v;
  der(v) = a;
  m*a = F - c*x;
  annotation(experiment(StopTime = 1, Interval = 0.25, Tolerance = 1e-9));
end Spring;
