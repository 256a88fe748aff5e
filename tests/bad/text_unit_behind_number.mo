//! E001 at 3: "expected"
model M
  parameter Real p = 5 bar;
end M;
