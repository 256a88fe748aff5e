//! b.c.r.x(0.5) = -2
//! b.c.r.y(0.5) = -3
model M
  record R
    Real x;
    Real y;
  end R;
  connector C
    Real e[2];
    flow R r;
  end C;
  model Source
    C c;
  equation
    c.r.x = 2;
    c.r.y = 3;
  end Source;
  model Level
    C c;
  equation
    c.e = {1, 2};
  end Level;
  Source a;
  Level b;
equation
  connect(a.c, b.c);
end M;
