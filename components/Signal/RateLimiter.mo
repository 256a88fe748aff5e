within Signal;
block RateLimiter "Limits of the rate of a signal"
  extends Bases.OneToOne;
  parameter Real rising(min = 1e-60) = 1 "Greatest rate";
  parameter Real falling(max = -1e-60) = -rising "Smallest rate, negative";
  parameter SI.Time T(min = 1e-9) = 1e-3 "Time in which the output follows within the limits";
  parameter Real y_start = 0 "Output at the start";
initial equation
  y = y_start;
equation
  assert(rising > 0 and falling < 0, "rising must be positive, falling negative");
  der(y) = smooth(0, if (u - y)/T > rising then rising elseif (u - y)/T < falling then falling else (u - y)/T);
  annotation(Documentation(info = "<html><p>Follows the input with the time constant T, at most with the given rates.</p></html>"));
end RateLimiter;
