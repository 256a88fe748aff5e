//! E010 at 3: "there is no class `real`"
model M
  parameter real k = 1;
end M;
