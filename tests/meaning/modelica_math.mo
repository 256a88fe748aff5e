//! a(0.17) = 0.168390157148
//! a(0.63) = 0.5621867439
//! b(0.17) = 1.35368589719
//! b(0.63) = 2.43566279482
//! c(0.17) = 1.06885442715
//! c(0.63) = 1.23335942023
//! d(0.17) = 1.73918648394
//! d(0.63) = 2.13298307069
//! e(0.17) = 1.25166538264
//! e(0.63) = 1.90671453348
//! f(0.89) = 3.14159265359
//! g(0.89) = 3
model M
  import Modelica.Math.*;
  Real a = atan2(time, 1);
  Real b = sinh(time) + Modelica.Math.cosh(time) + tanh(time);
  Real c = log(1 + time) + Modelica.Math.log10(1 + time) + exp(-time);
  Real d = asin(0.5*time) + acos(0.5*time) + atan(time);
  Real e = sqrt(time + 1) + abs(-time);
  Real f = Modelica.Constants.pi;
  Real g = sign(-2) + 4;
end M;
