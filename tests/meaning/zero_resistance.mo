//! b(1) = 2.02683423806
//! i(1) = -0.328858079
//! c(1) = 1
model M "Parameters of value 0 that tie states together, or leave none"
  parameter Real R = Rs[2];
  parameter Real Rs[2] = {1, 0};
  parameter Real C0 = 0;
  Real a(start = 3, fixed = true), b, i, c, capacity;
equation
  // two capacities joined without a resistance
  der(a) = -a/2 - i;
  2*der(b) = i - 1.5*b + 2;
  R*i = a - b;
  // a capacity that a function of the voltage makes 0, whatever the voltage
  capacity = if c < 0.5 then C0*exp(c) else C0/2*(1 + c);
  capacity*der(c) = 1 - c;
end M;
