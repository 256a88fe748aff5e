//! n(0.1) = 10
//! n(0.2) = 30
//! n(1) = 550
//! odd(1) = 25
model M "Peaks of a function of time with values that are sampled: k goes up each 0.1 s"
  constant Real pi = 3.141592653589793;
  discrete Real k(start = 0, fixed = true);
  discrete Real began(start = 0, fixed = true);
  discrete Real level(start = 2, fixed = true);
  Integer n(start = 0, fixed = true) "10 k peaks in each 0.1 s";
  Integer odd(start = 0, fixed = true) "5 peaks in each 0.1 s of odd k";
  Real z(start = 1, fixed = true);
equation
  der(z) = -0.001*z;
  when sample(0, 0.1) then
    k = pre(k) + 1;
    began = time;
    level = 3 - pre(level);
  end when;
  when sin(2*pi*100*k*(time - began)) > 0.9999 then
    n = pre(n) + 1;
  end when;
  when sin(2*pi*50*time) > 0.9999*level then
    odd = pre(odd) + 1;
  end when;
end M;
