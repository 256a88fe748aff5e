//! stop 2
//! n(1) = 50
//! n(2) = 100
//! m(2) = 100
//! x(1) = 1.42364374
//! x(2) = 2.84728748
model M "Peaks of time, shorter than the steps of the integrator: 100 of 100 are seen, and last as long as they do"
  constant Real pi = 3.141592653589793;
  Real u = sin(2*pi*50*time);
  Real z(start = 1, fixed = true);
  Real x(start = 0, fixed = true) "50 peaks a second of acos(0.999)/(50 pi), in hundredths of a second";
  Integer n(start = 0, fixed = true);
  Integer m(start = 0, fixed = true);
equation
  der(z) = -0.001*z;
  der(x) = if u > 0.999 then 100 else 0;
  when sin(2*pi*50*time) > 0.999999 then
    n = pre(n) + 1;
  end when;
  when u < -0.99999999 then
    m = pre(m) + 1;
  end when;
end M;
