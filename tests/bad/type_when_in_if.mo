//! E021 at 7: "inside an `if` whose condition changes"
model M
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
  if x > 0.5 then
    when time > 0.2 then
      reinit(x, 0);
    end when;
  end if;
end M;
