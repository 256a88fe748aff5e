//! E210 at 7: "enumeration"
model M
  type Gear = enumeration(first, second);
  parameter Gear gear = Gear.first;
  Real x;
equation
  x = gear + 1;
end M;
