//! E303 at 14: "holds no unknown"
//! model P.M
package P
  connector Out = output Real;
  connector In = input Real;
  block B
    In u;
    Out y = u;
  end B;
  model M
    B a, b;
  equation
    connect(a.y, b.u);
    connect(b.y, a.u);
  end M;
end P;
