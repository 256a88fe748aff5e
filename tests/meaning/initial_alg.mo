//! x(0.17) = 3.37465926639
//! x(0.63) = 2.13036720403
//! y(0.89) = 12
model M
  Real x;
  parameter Real p(fixed = false);
  discrete Real y;
protected
  parameter Integer n = 3;
initial algorithm
  p := 0;
  for i in 1:n loop
    p := p + 1;
  end for;
  x := p + 1;
  y := 12;
equation
  der(x) = -x;
  when time > 5 then
    y = 1;
  end when;
end M;
