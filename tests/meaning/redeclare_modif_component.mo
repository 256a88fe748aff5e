//! model P.M
//! h.c.y(0.17) = 0.51
//! h.c.y(0.63) = 1.89
//! g.c.y(0.17) = 0.289
//! g.c.y(0.63) = 3.969
//! g2.c.y(0.17) = 0.578
//! g2.c.y(0.63) = 7.938
package P
  partial model I
    parameter Real k = 1;
    Real y;
  end I;
  model L
    extends I;
  equation
    y = k*time;
  end L;
  model Q
    extends I;
    parameter Real e = 2;
  equation
    y = k*time^e*f;
  protected
    parameter Real f = 1;
  end Q;
  model Q2
    extends Q(f = 2);
  end Q2;
  model H
    replaceable L c(k = 2) constrainedby I(k = 3);
  end H;
  model M
    H h;
    H g(redeclare Q c(k = 10));
    H g2(redeclare replaceable Q2 c(k = 10));
  end M;
end P;
