//! E027 at 6: "`a` is a component of a model and cannot be `parameter`"
model M
  model A
    Real x = 1;
  end A;
  parameter A a;
end M;
