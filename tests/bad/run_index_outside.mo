//! run
//! E503 at 6: "the index 4 lies outside 1..3"
model M
  parameter Real v[3] = {1, 2, 3};
  Integer k(start = 1, fixed = true);
  Real y = v[k];
  Real z = if k <= 3 then v[k] else 0;
equation
  when sample(0.1, 0.1) then
    k = pre(k) + 1;
  end when;
end M;
