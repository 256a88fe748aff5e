//! E303 at 8: "faces"
model Sphere
  constant Integer faces = 6;
end Sphere;
model M
  Sphere sphere;
equation
  sphere.faces = 7;
end M;
