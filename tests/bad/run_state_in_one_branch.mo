//! run
//! E403 at 8: "a state in one branch"
model M
  Real a(start = 1, fixed = true), b;
equation
  der(a) = 1;
  if time <= 3 then
    b = a;
  else
    der(b) = -1;
  end if;
end M;
