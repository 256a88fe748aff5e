//! stop 1
//! u[1](1) = 0.6
//! u[2](1) = 0.8
model M
  parameter Real n[2] = {3, 4} annotation(Evaluate = true);
  function unit
    input Real v[:];
    output Real result[size(v, 1)];
  algorithm
    result := smooth(0, if sqrt(v*v) >= 1e-10 then v/sqrt(v*v) else v/1e-10);
    annotation(Inline = true);
  end unit;
  model Arrow
    input Real r[2] = {0, 0};
    Real x[2] = r;
  end Arrow;
  Arrow arrow(r = unit(n)*1.0);
  Real u[2] = arrow.x;
end M;
