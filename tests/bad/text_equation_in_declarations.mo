//! E001 at 4: "expected a declaration or `equation`"
model M
  Real x;
  x = 1;
end M;
