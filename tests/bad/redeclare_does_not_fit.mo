//! E015 at 20: "cannot take the place of"
partial model Law
  Real v;
  Real f;
end Law;
model Viscous
  extends Law;
equation
  f = 10*v;
end Viscous;
model Lamp
  Real i = 1;
end Lamp;
model Friction
  replaceable Viscous law constrainedby Law;
equation
  law.v = 1;
end Friction;
model M
  Friction friction(redeclare Lamp law);
end M;
