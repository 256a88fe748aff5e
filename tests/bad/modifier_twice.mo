//! E027 at 6: "`x` is given a value twice"
model M
  model A
    parameter Real x = 0;
  end A;
  A a(x = 1, x = 2);
end M;
