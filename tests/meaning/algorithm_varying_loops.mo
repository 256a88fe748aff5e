//! model M
//! stop 2
//! a[2](1.1) = 1
//! a[3](0.9) = 0
//! a[3](1.1) = 1
//! s(1.9) = 6
//! g[2,1](1.9) = 5
//! n(1.9) = 3
//! q(1.9) = 6
//! f(1.44) = 2
//! f(1.3) = 1
//! root(1.5) = 1.224744871391589
//! bub[1](0.5) = -0.5
//! bub[3](1.5) = 1.5
//! late(1.5) = 3
model M "algorithm: index and loop bounds that change at events, break in loops, dynamic places in matrices"
  Integer k(start = 1, fixed = true);
  Integer a[3](each start = 0, each fixed = true);
  Integer s, n, q, f;
  Real g[2, 2], root, bub[3], late;
protected
  Real tmp, e;
algorithm
  when sample(0.5, 0.5) then
    k := pre(k) + 1;
    a[min(k, 3)] := 1;
  end when;
algorithm
  s := 0;
  for i in 1:min(k, 3) loop
    s := s + i;
  end for;
  g := zeros(2, 2);
  g[min(k, 2), 1] := 5;
  n := 0;
  while n < 3 and n < k loop
    n := n + 1;
  end while;
algorithm
  q := 0;
  for i in {1, 2, 3, 4} loop
    if i > 3 then
      break;
    end if;
    q := q + i;
  end for;
  f := 0;
  for i in 1:3 loop
    if time < 0.7*i then
      break;
    end if;
    f := f + 1;
  end for;
algorithm
  root := 1;
  e := 1;
  while e > 1e-12 loop
    e := root;
    root := (root + time/root)/2;
    e := abs(e - root);
  end while;
algorithm
  bub := {time, -time, 0.3};
  for i in 1:2 loop
    for j in 1:3 - i loop
      if bub[j] > bub[j + 1] then
        tmp := bub[j];
        bub[j] := bub[j + 1];
        bub[j + 1] := tmp;
      end if;
    end for;
  end for;
algorithm
  late := if time > 0.75 then 1 else 0;
  for i in 1:integer(time) + 1 loop
    late := late + 1;
  end for;
end M;
