//! E021 at 6: "`reinit` cannot stand in an algorithm"
model M
  Real x(start = 0, fixed = true);
algorithm
  when x > 0.5 then
    reinit(x, 0);
  end when;
equation
  der(x) = 1;
end M;
