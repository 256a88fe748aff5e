//! model P.M
//! s.a.b.x(0.89) = 7
//! s.a.b.y(0.17) = 0.51
//! s.a.b.y(0.63) = 1.89
//! s.c[1].b.x(0.89) = 4
//! s.c[2].b.x(0.89) = 9
//! q.a.b.x(0.89) = 8
package P
  model B
    parameter Real k = 1;
    Real x = k;
    Real y = time;
  end B;
  model A
    B b(k = 2);
  end A;
  model S
    parameter Real z = 0;
    A a(b.k = 7 + z);
    A c[2](b(k = {4, 9}));
  end S;
  model M
    S s(a(b(y = 3*time)));
    S q(a.b.k = 8);
  end M;
end P;
