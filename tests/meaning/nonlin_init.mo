//! x(0.17) = 1.97116953382
//! x(0.63) = 1.61605501662
//! E(0.89) = 2
//! phi0(0.89) = 0.523598775598
model M
  Real x(start = 1), v;
  Real E = (x^2 + v^2)/2;
  Real phi0;
  parameter Real s(fixed = false, start = 1.2);
initial equation
  E = 2;
  v = 0;

  s^3 = 1;
equation
  der(x) = v;
  der(v) = -x;
  sin(phi0) = 0.5;
end M;
