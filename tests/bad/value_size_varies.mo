//! E212 at 4: "`n` is not known before the run"
model M
  Integer n = integer(time);
  Real x[n];
end M;
