//! E210 at 5: "Boolean"
model M
  Boolean b;
equation
  b = time and true;
end M;
