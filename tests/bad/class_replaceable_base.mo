//! E027 at 6: "is replaceable and cannot be a base class"
model M
  replaceable model Base
    Real x = 1;
  end Base;
  extends Base;
end M;
