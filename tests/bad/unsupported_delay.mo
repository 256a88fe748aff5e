//! E017 at 3: "`delay()`"
model M
  Real x = delay(sin(time), 0.1);
end M;
