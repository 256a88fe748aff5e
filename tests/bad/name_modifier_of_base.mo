//! model M
//! E012 at 10: "has no element `gain` to modify"
model Base
  parameter Real k = 1;
  Real x;
equation
  x = k;
end Base;
model M
  extends Base(gain = 2);
end M;
