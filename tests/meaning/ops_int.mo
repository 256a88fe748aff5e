//! stop 1.9
//! a(1.691) = -3
//! b(1.691) = 2
//! c(1.691) = -1
//! d(1.691) = 2
//! e(1.691) = -4
//! f(1.691) = -3
//! g(1.691) = 3
//! r(1.691) = -1.5
//! m(1.691) = 0.5
//! ceilt(0.323) = 0
//! ceilt(1.197) = 3
//! fl(0.323) = -1
//! fl(1.197) = 2
//! it(0.323) = -1
//! it(1.197) = 2
//! k(1.691) = -2
//! sg(0.323) = -1
//! sg(1.197) = 1
model M
  Integer a = div(-7, 2);
  Integer b = mod(-7, 3);
  Integer c = rem(-7, 3);
  Integer d = mod(7, 5);
  Integer e = integer(-3.2);
  Real f = ceil(-3.2);
  Integer g = abs(-3);
  Real r = rem(-7.5, 2);
  Real m = mod(-7.5, 2);
  Real ceilt = ceil(3*time - 1);
  Real fl = floor(3*time - 1);
  Integer it = integer(3*time - 1);
  Integer k = mod(7, -3);
  Integer sg = sign(time - 1);
end M;
