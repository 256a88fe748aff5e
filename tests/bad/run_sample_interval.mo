//! run
//! E506 at 6: "give the parameters of the interval positive values"
model M
  parameter Real Ts = 0;
  Integer n(start = 0, fixed = true);
  Boolean tick = sample(0, Ts);
equation
  when tick then
    n = pre(n) + 1;
  end when;
end M;
