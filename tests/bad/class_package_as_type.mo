//! E024 at 3: "`Hydraulic` is a package"
model M
  Hydraulic pump;
end M;
