//! y(0.79) = 0
//! y(0.81) = 2
//! z(1) = 0.4
//! seen(1) = 0.8
//! twice(0.94) = 0
//! twice(0.96) = 2
//! slope(0.5) = 1
//! early(0.1) = 3
//! early(0.9) = 3.4
// A jump comes out as a jump, one delay later, and is an event for what watches it; delays add up; before one delay has
// passed the value at the start holds.
model M
  Real u, y, z(start = 0, fixed = true), twice, slope, early, x(start = 3, fixed = true);
  discrete Real seen(start = 0, fixed = true);
equation
  u = if time >= 0.3 then 2 else 0;
  y = delay(u, 0.5);
  der(z) = y;
  twice = delay(y, 0.15);
  der(x) = 1;
  slope = der(delay(x, 0.25));
  early = delay(x, 0.5, 2);
  when y > 1 then
    seen = time;
  end when;
end M;
