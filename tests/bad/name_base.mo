//! model M
//! E010 at 4: "there is no class `Oscilator`"
model M
  extends Oscilator;
end M;
model Oscillator
  Real x(start = 1, fixed = true);
equation
  der(x) = -x;
end Oscillator;
