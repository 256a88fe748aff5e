//! E027 at 6: "a record cannot have equations or algorithms"
model M
  record R
    Real x;
  equation
    x = 1;
  end R;
  R r;
end M;
