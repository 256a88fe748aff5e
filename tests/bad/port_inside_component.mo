//! E105 at 15: "`a.b` is a component inside another one"
model M
  connector C
    Real e;
    flow Real f;
  end C;
  model Inner
    C c;
  end Inner;
  model Outer
    Inner b;
  end Outer;
  Outer a;
equation
  connect(a.b.c, d.c);
  a.b.c.e = 1;
  Inner d;
end M;
