//! model M
//! E018 at 3: "is partial and cannot be run"
partial model M
  Real x;
end M;
