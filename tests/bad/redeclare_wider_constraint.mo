//! E015 at 14: "cannot take the place of"
model M
  model Small
    Real x = 1;
  end Small;
  model Large
    Real x = 1;
    Real y = 2;
  end Large;
  model Base
    replaceable Large part constrainedby Large;
  end Base;
  model Derived
    extends Base(replaceable Large part constrainedby Small);
  end Derived;
  Derived d;
end M;
