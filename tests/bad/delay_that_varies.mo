//! E017 at 5: "a `delay` whose time changes during the run is not supported"
model M
  Real x;
equation
  x = delay(sin(time), 0.1 + 0.05*time, 1);
end M;
