//! E305 at 7: "x"
model M
  Real x;
equation
  x = sin(time);
  when time > 0.5 then
    reinit(x, 0);
  end when;
end M;
