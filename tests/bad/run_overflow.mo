//! run
//! E504 at 6: "exp"
model M
  Real x;
equation
  x = exp(1000*time);
end M;
