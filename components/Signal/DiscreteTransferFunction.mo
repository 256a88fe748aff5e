within Signal;
block DiscreteTransferFunction "Sampled transfer function, coefficients of falling powers of z"
  extends Bases.Sampled(y(start = 0, fixed = true));
  parameter Real b[:] = {1} "Numerator";
  parameter Real a[:] = {1, -0.5} "Denominator, not of lower degree";
protected
  parameter Integer n = size(a, 1) - 1 "Order";
  parameter Real c[size(a, 1)] = cat(1, zeros(size(a, 1) - size(b, 1)), b)/a[1] "Numerator, padded and scaled";
  parameter Real d[size(a, 1)] = a/a[1] "Denominator, scaled";
  discrete Real x[n](each start = 0, each fixed = true) "States, newest first";
  discrete Real v(start = 0, fixed = true) "Newest state before the shift";
equation
  assert(size(a, 1) >= size(b, 1), "The numerator must not be of higher degree than the denominator");
  assert(abs(a[1]) > 0, "The leading coefficient of the denominator must not be zero");
  when tick then
    v = u - sum(d[i + 1]*pre(x[i]) for i in 1:n);
    y = c[1]*v + sum(c[i + 1]*pre(x[i]) for i in 1:n);
    x[1] = v;
    for i in 2:n loop
      x[i] = pre(x[i - 1]);
    end for;
  end when;
  annotation(Documentation(info = "<html><p><code>(b_1 z^m + .. )/(a_1 z^n + ..)</code>, carried out at the samples, the output held between: any linear controller or filter as it stands in a drive's software. Order at least one.</p></html>"));
end DiscreteTransferFunction;
