//! E019 at 7: "`area`"
model Sphere
  parameter Real radius = 1;
  final parameter Real area = 4*3.14*radius^2;
end Sphere;
model M
  Sphere sphere(area = 3);
end M;
