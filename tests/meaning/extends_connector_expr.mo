//! model P.M
//! a.f.v(0.17) = 0.17
//! a.f.v(0.63) = 0.63
//! e.y(0.17) = 0.34
//! e.y(0.63) = 1.26
package P
  type V = Real(unit = "V");
  partial connector Base
    V v;
  end Base;
  connector Full
    extends Base;
    flow Real i(unit = "A");
  end Full;
  connector Out = output Real;
  model A
    Full f;
  equation
    f.v = time;
  end A;
  model B
    Full f;
    Out y = 2*f.v;
  equation
    f.i = 0;
  end B;
  model M
    A a;
    B e;
  equation
    connect(a.f, e.f);
  end M;
end P;
