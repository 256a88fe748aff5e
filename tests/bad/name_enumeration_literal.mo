//! E011 at 4: "`third`"
model M
  type Gear = enumeration(first, second);
  parameter Gear gear = Gear.third;
end M;
