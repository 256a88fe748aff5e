//! E021 at 6: "`Connections.conserved(quantity, rate, state)` takes three real numbers, the last one a variable"
model M
  Real x(start = 1, fixed = true);
equation
  der(x) = -x;
  Connections.conserved(x, -x, 2*x);
end M;
