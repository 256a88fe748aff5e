//! stop 1.05
//! n[1](0.1785) = 1
//! n[1](0.6615) = 6
//! n[2](0.1785) = 0
//! n[2](0.6615) = 2
//! x(0.1785) = 0.5
//! x(0.6615) = 3
//! y(0.1785) = 0.1785
//! y(0.6615) = 0.6615
model M
  parameter Real T[2] = {0.1, 0.25};
  Integer n[2](each start = 0, each fixed = true);
  discrete Real x(start = 0, fixed = true);
  Real y(start = 0, fixed = true);
equation
  der(y) = 1;
  for i in 1:2 loop
    when sample(T[i], T[i]) then
      n[i] = pre(n[i]) + 1;
    end when;
  end for;
algorithm
  when sample(0.1, 0.1) then
    x := pre(x) + 0.5;
  end when;
end M;
