//! model P.M
//! a.v.y(0.17) = 0.34
//! a.v.y(0.63) = 1.26
//! b.v.y(0.89) = -3
//! c.x[2].v.y(0.89) = -3
package P
  partial model V
    Real y;
    parameter Real k = 1;
  end V;
  model V1
    extends V;
  equation
    y = k*time;
  end V1;
  model V2
    extends V;
    parameter Boolean neg = false;
  equation
    y = if neg then -k else k;
  end V2;
  model H
    replaceable V1 v(k = 2) constrainedby V annotation(choicesAllMatching = true);
  end H;
  model C
    parameter Integer n = 2;
    replaceable H x[n];
  end C;
  model M
    H a;
    H b(redeclare V2 v(k = 3, neg = true));
    C c(x(redeclare each V2 v(k = 3, neg = true)));
  end M;
end P;
