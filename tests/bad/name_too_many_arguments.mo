//! E021 at 5: "`sin` takes one argument, not 2"
model M
  Real x;
equation
  x = sin(time, 2);
end M;
