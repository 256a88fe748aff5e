//! E015 at 12: "`law` is not replaceable"
model Law
  Real f = 1;
end Law;
model Other
  Real f = 2;
end Other;
model Friction
  Law law;
end Friction;
model M
  Friction friction(redeclare Other law);
end M;
