//! E001 at 3: "found the keyword `connect`"
model M
  Real connect;
end M;
