//! E027 at 4: "`time` is not known in a record"
model M
  record R
    Real x = time;
  end R;
  R r;
end M;
