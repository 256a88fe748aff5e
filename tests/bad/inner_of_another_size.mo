//! E016 at 5: "`inner p` has size [10], and `outer p` [6]"
model M
  inner Real p[10] = fill(1, 10);
  model A
    outer Real p[6];
    Real x = p[5];
  end A;
  A a;
end M;
