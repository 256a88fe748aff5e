//! stop 2
//! y(0.34) = 10.34
//! y(1.26) = 11.52
//! s(0.34) = 3.4
//! s(1.26) = 12.6
//! v[2](0.34) = 0.1156
//! v[2](1.26) = 1.5876
//! v[3](0.34) = 0.039304
//! v[3](1.26) = 2.000376
//! z(0.34) = 0.711770322763
//! z(1.26) = 0.2836540265
model M "algorithm section with while, arrays, state use"
  Real y;
  Real s;
  Real v[3];
  Real z(start = 1, fixed = true);
protected
  Integer k;
algorithm
  y := time;
  if y > 1 then
    y := 2*y - 1;
  end if;
  y := y + 10;
  s := 0;
  k := 1;
  while k <= 4 loop
    s := s + k*time;
    k := k + 1;
  end while;
  v[1] := time;
  for i in 2:3 loop
    v[i] := v[i - 1]*time;
  end for;
equation
  der(z) = -z;
end M;
