//! E212 at 4: "`x` is not known before the run"
model M
  Real x = time;
  parameter Real k = 2*x;
end M;
