//! x(1) = 3
//! y(1) = 6
model M
  parameter Boolean large(fixed = false);
  parameter Integer k(fixed = false);
  parameter Real limit = 2;
  Real x, y;
  function double
    input Integer n;
    output Integer m;
  algorithm
    m := 2*n;
  end double;
initial equation
  k = if limit > 1 then 3 else 4;
initial algorithm
  large := false;
  if limit > 1 then
    large := true;
  end if;
equation
  if large then
    x = 3;
  else
    x = 4;
  end if;
  y = double(k);
end M;
