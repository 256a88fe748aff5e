//! E211 at 3: "3"
model M
  Mechanical.Translational.Mass mass[3](m = {1, 2});
end M;
