within Signal;
block Derivative "Derivative with a lag: k s/(T s + 1)"
  extends Bases.OneToOne;
  parameter Real k = 1 "Gain";
  parameter SI.Time T(min = 1e-9) = 0.01 "Time constant";
  parameter Real x_start = 0 "Filtered input at the start";
  Real x(start = x_start, fixed = true) "Filtered input";
equation
  assert(T > 0, "The time constant T must be positive");
  der(x) = (u - x)/T;
  y = k/T*(u - x);
  annotation(Documentation(info = "<html><p><code>k s/(T s + 1)</code>: the derivative up to the frequency <code>1/T</code>.</p></html>"));
end Derivative;
