//! E210 at 6: "`gain` is a component and cannot have a value"
model Gain
  parameter Real k = 1;
end Gain;
model M
  Gain gain = 3;
end M;
