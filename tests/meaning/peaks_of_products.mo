//! n(1) = 10
//! n(0.5) = 5
//! x(1) = 0.6394026279
//! far(1) = 0
//! over(1) = 1
model M "A beat, whose peaks reach their level only now and then"
  constant Real pi = 3.141592653589793;
  Real u = sin(2*pi*50*time)*sin(2*pi*51*time);
  Real x(start = 0, fixed = true) "how long the beat is above 0.98, in hundredths of a second";
  Integer n(start = 0, fixed = true);
  Integer far(start = 0, fixed = true) "sin cos is 0.5 at most";
  Integer over(start = 0, fixed = true) "of the largest peaks, 0.99975816, the first is seen: the other stands behind 0.5 s";
equation
  der(x) = if u > 0.98 then 100 else 0;
  when u > 0.98 then
    n = pre(n) + 1;
  end when;
  when sin(2*pi*1000*time)*cos(2*pi*1000*time) > 0.5001 then
    far = pre(far) + 1;
  end when;
  when (if time < 0.5 then u else 0) > 0.99975 then
    over = pre(over) + 1;
  end when;
end M;
