//! stop 0.1
//! n(0.005) = 1
//! n(0.045) = 3
//! n(0.097) = 5
//! x(0.097) = 0.90755604
model M "relations of a source that no state follows"
  Real x(start = 1, fixed = true);
  Real u = sin(314.1592653589793*time);
  Boolean b = u > 0;
  Integer n(start = 0, fixed = true);
equation
  der(x) = -x;
  when b then
    n = pre(n) + 1;
  end when;
end M;
