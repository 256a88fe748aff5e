within Signal;
block TransferFunction "Rational transfer function, coefficients of falling powers of s"
  extends Bases.OneToOne;
  parameter Real b[:] = {1} "Numerator";
  parameter Real a[:] = {1, 1} "Denominator, not of lower degree";
  parameter Real x_start[size(a, 1) - 1] = zeros(size(a, 1) - 1) "States at the start";
  Real x[size(a, 1) - 1](start = x_start, each fixed = true) "States, controllable form";
protected
  parameter Integer n = size(a, 1) - 1 "Order";
  parameter Real c[size(a, 1)] = cat(1, zeros(size(a, 1) - size(b, 1)), b)/a[1] "Numerator, padded and scaled";
  parameter Real d[size(a, 1)] = a/a[1] "Denominator, scaled";
equation
  assert(size(a, 1) >= size(b, 1), "The numerator must not be of higher degree than the denominator");
  assert(abs(a[1]) > 0, "The leading coefficient of the denominator must not be zero");
  for i in 1:n - 1 loop
    der(x[i]) = x[i + 1];
  end for;
  if n > 0 then
    der(x[n]) = u - sum(d[n + 2 - i]*x[i] for i in 1:n);
  end if;
  y = c[1]*u + sum((c[n + 2 - i] - c[1]*d[n + 2 - i])*x[i] for i in 1:n);
  annotation(Documentation(info = "<html><p><code>(b_1 s^m + .. )/(a_1 s^n + ..)</code> in controller canonical form; coefficients by falling powers of s, <code>m &lt;= n</code>.</p></html>"));
end TransferFunction;
