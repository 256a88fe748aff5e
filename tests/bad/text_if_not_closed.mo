//! E002 at 5: "this `if` is not closed"
model M
  Real x;
equation
  if time > 1 then
    x = 1;
  else
    x = 2;
end M;
