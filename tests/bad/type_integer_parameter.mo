//! E210 at 3: "Integer"
model M
  parameter Integer n = 2.5;
end M;
