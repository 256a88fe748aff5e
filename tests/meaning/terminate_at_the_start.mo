//! x(0) = 1
model M
  Real x(start = 1, fixed = true);
initial algorithm
  if x > 0.5 then
    terminate("enough at the start");
  end if;
equation
  der(x) = -x;
end M;
