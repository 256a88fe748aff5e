//! run
//! E215 at 7: "the time of a `delay` must be positive"
model M
  parameter Real T = 0;
  Real x;
equation
  x = delay(sin(time), T);
end M;
