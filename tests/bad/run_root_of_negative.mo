//! run
//! E504 at 7: "sqrt"
model Valve
  Real dp;
  Real q;
equation
  q = sqrt(dp);
end Valve;
model M
  Valve valve;
equation
  valve.dp = 0.5 - time;
end M;
