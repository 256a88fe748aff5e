//! model P.M
//! a.y(0.89) = 5
//! b.y(0.17) = 1.02
//! b.y(0.63) = 3.78
package P
  model A
    parameter Real k = 1;
    final parameter Real k2 = 2*k;
    Real y = kp + k2;
  protected
    parameter Real kp = k + 1;
  end A;
  model D
    parameter Real k = 3;
  end D;
  model C
    parameter Real f = 4;
    D d(k = 3*f);
    D e;
  end C;
  model B
    extends A(final k = 2, y = 6*time);
  end B;
  model A2
    parameter Real k = 1;
    Real y = k;
  end A2;
  model B2
    extends A2(k = 6, y = k*time);
  end B2;
  model M
    A a(k = 4/3);
    B2 b;
    C c;
  end M;
end P;
