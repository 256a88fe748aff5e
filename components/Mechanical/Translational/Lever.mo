within Mechanical.Translational;
model Lever "Rigid lever with two ends and a pivot, without loss"
  Interfaces.TranslationalFlange flange_a "End a";
  Interfaces.TranslationalFlange flange_b "End b, on the other side of the pivot";
  Interfaces.TranslationalFlange pivot "Pivot; join it to Fixed where it is at rest";
  parameter SI.Length l_a(min = 1e-4, max = 1e3, nominal = 0.1) = 0.1 "Length from the pivot to end a";
  parameter SI.Length l_b(min = 1e-4, max = 1e3, nominal = 0.1) = 0.1 "Length from the pivot to end b";
  parameter Boolean sameSide = false "true: both ends lie on the same side of the pivot" annotation(Evaluate = true);
  parameter Boolean exact = true "true: the angle is the arc sine of the way over the length, false: their quotient" annotation(Evaluate = true);
  SI.Angle phi(displayUnit = "deg") "Angle of the lever from its middle position, positive towards positive a";
protected
  parameter Real ratio(unit = "1") = if sameSide then l_b/l_a else -l_b/l_a "Way of b over way of a, seen from the pivot";
  Real x(unit = "1") "Way of a over its length, seen from the pivot";
equation
  assert(l_a > 0 and l_b > 0, "The lengths l_a and l_b must be positive");
  assert(abs(x) < 1, "The ends of the lever are further apart along the path than the lever is long");
  x = (flange_a.s - pivot.s)/l_a;
  flange_b.s - pivot.s = ratio*(flange_a.s - pivot.s);
  flange_a.f + ratio*flange_b.f = 0;
  flange_a.f + flange_b.f + pivot.f = 0;
  phi = if exact then asin(noEvent(min(max(x, -1), 1))) else x;
  annotation(Documentation(info = "<html><p><code>s_b - s_p = -(l_b/l_a) (s_a - s_p)</code>, <code>f_a l_a = f_b l_b</code>, the pivot carries both forces. All three move along parallel lines, the ends by the sine of the angle times their length: the ratio of ways and of forces therefore holds at any angle, only the angle itself is the arc sine, <code>phi = (s_a - s_p)/l_a</code> for small ones. A pivot that moves adds two signals mechanically: the feedback lever of a servo cylinder.</p></html>"));
end Lever;
