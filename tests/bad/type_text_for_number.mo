//! E210 at 3: "`d` is a Real and cannot take a String"
model M
  parameter Real d = "2 mm";
  Real x = d*time;
end M;
