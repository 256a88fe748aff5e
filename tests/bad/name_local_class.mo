//! E010 at 8: "there is no class `Sprng`"
model Spring
  Real f;
equation
  f = 1;
end Spring;
model M
  Sprng spring;
end M;
