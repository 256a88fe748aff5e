//! E011 at 6: "there is no `stifness` here"
model M
  parameter Real stiffness = 1;
  Real f;
equation
  f = stifness*time;
end M;
