//! E002 at 3: "the string is not closed"
model M
  Real x "position;
equation
  x = 1;
end M;
