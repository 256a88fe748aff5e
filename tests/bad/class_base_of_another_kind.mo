//! E027 at 7: "a record cannot extend a model"
model M
  model Base
    parameter Real x = 1;
  end Base;
  record R
    extends Base;
  end R;
  R r;
end M;
