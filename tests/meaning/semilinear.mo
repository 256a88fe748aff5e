//! y(0.17) = 1.7042160439
//! y(0.63) = -1.78775167142
//! z(0.17) = 1.57009785375
//! z(0.63) = -2.40913759701
model M
  Real x = sin(6*time);
  Real y = semiLinear(x, 2, 3);
  Real z;
equation
  3*cos(6*time) = smooth(0, noEvent(if z > 0 then z else z));
end M;
