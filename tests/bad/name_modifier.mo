//! E012 at 3: "has no element `mas` to modify"
model M
  Mechanical.Translational.Mass mass(mas = 3);
end M;
