within Signal;
block LeadLag "Lead or lag: k (T_1 s + 1)/(T_2 s + 1)"
  extends Bases.OneToOne;
  parameter Real k = 1 "Gain";
  parameter SI.Time T_1 = 0.1 "Time constant of the numerator";
  parameter SI.Time T_2(min = 1e-9) = 0.01 "Time constant of the denominator";
  parameter Real x_start = 0 "State at the start";
  Real x(start = x_start, fixed = true) "Lagged input";
equation
  assert(T_2 > 0, "The time constant T_2 must be positive");
  T_2*der(x) = u - x;
  y = k*(x + T_1/T_2*(u - x));
  annotation(Documentation(info = "<html><p><code>k (T_1 s + 1)/(T_2 s + 1)</code>.</p></html>"));
end LeadLag;
