//! E210 at 5: "Boolean"
model M
  Real x(start = 0, fixed = true);
equation
  when time - 1 then
    x = 1;
  end when;
end M;
