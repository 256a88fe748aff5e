//! stop 2
//! y(0.34) = 0.68
//! y(1.26) = 2.52
//! n(0.34) = 0
//! n(1.26) = 1
//! s(0.34) = 1.02
//! s(1.26) = 3.78
model M
  Real y;
  Real s;
  Integer n(start = 0, fixed = true);
algorithm
  y := time;
  assert(y >= 0, "negative");
  y := 2*y;
algorithm
  s := 0;
  for i in 1:2 loop
    s := s + i*time;
    assert(s < 100, "large " + String(i), AssertionLevel.warning);
  end for;
algorithm
  when time >= 1 then
    n := n + 1;
    assert(n < 5, "often");
  elsewhen time >= 5 then
    terminate("end");
  end when;
end M;
