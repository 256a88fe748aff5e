//! r(1) = 4
//! s(1) = 2
// all outputs of a call are computed before one is assigned, also where the call's arguments are its targets (MLS 12.4.3)
model M
  function swapped
    input Real x;
    input Real y;
    output Real p;
    output Real q;
  algorithm
    p := x;
    q := y + 0;
  end swapped;
  function often
    input Real x;
    input Integer n;
    output Real r;
    output Real s;
  protected
    Integer k;
  algorithm
    r := x;
    s := 2*x;
    k := 0;
    while k < n and r < 1e3 loop
      (r, s) := swapped(s, r);
      k := k + 1;
    end while;
  end often;
  Integer n(start = 0, fixed = true);
  Real r, s;
equation
  when sample(0.3, 0.3) then
    n = pre(n) + 1;
  end when;
  (r, s) = often(1 + time, n);
end M;
