//! E012 at 6: "has no element `g`"
model Friction
  Real f = 1;
end Friction;
model M
  Friction friction(redeclare Real g);
end M;
