//! E201 at 5: "holds no unknown"
model Sphere
  constant Integer faces = 6;
end Sphere;
model M
  Sphere sphere;
equation
  sphere.faces = 7;
end M;
