//! model Wheel
//! E218 at 4: "nested without end"
model Wheel
  Wheel spare;
  Real x = 1;
end Wheel;
