//! model P.M
//! b.x(0.17) = 0.34
//! b.x(0.63) = 1.26
//! b.f(0.89) = -5
package P "hierarchical connector"
  connector E
    Real v;
    flow Real i;
  end E;
  connector H
    E e1;
    E e2;
    Real s;
    flow Real q;
  end H;
  model A
    H h;
  equation
    h.e1.v = time;
    h.e2.v = 2*time;
    h.s = 3;
  end A;
  model B
    H h;
    Real x = h.e2.v;
    Real f = h.e1.i - 5;
  equation
    h.e1.i = 0;
    h.e2.i = 1;
    h.q = 0;
  end B;
  model M
    A a;
    B b;
  equation
    connect(a.h, b.h);
  end M;
end P;
