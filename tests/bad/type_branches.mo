//! E210 at 5: "Boolean"
model M
  Real x;
equation
  x = if time > 1 then 1 else false;
end M;
