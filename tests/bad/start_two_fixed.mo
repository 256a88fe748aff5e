//! E401: "`left.s` and `right.s` are equal but start at different values"
model M
  Mechanical.Translational.Mass left(s(start = 0, fixed = true));
  Mechanical.Translational.Mass right(s(start = 1, fixed = true));
equation
  connect(left.flange_b, right.flange_a);
end M;
