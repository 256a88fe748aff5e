//! E210 at 6: "write `pre(n)` for the value before the event"
model M
  Integer n(start = 0, fixed = true);
equation
  when sample(0, 0.1) then
    n = n + 1;
  end when;
end M;
