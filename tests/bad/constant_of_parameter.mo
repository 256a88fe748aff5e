//! E212 at 4: "the constant `y` is given a value that parameters change"
model M
  parameter Real x = 6;
  constant Real y = x;
end M;
