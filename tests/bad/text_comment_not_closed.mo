//! E002 at 4: "the comment is not closed"
model M
  Real x;
  /* the position
equation
  x = 1;
end M;
