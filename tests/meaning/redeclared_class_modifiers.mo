//! model P.Top
//! a.r.y(0.5) = 3
//! b.r.y(0.5) = 1.75
//! c.r.y(0.5) = 2.5
//! d.h[1].r.y(0.5) = 3.5
//! d.h[2].r.y(0.5) = 4
//! e.x.r.y(0.5) = 6.5
//! g.inside.r.y(0.5) = 8
//! i.r.y(0.5) = 5.5
//! j.r.s.y(0.5) = 2
package P "what modifies a replaceable class: the redeclaration before the `constrainedby` (MLS 7.3.2)"
  partial model I
    parameter Real k = 1;
    Real y;
  end I;
  model L
    extends I;
    parameter Real o = 2;
  equation
    y = k*time + o;
  end L;
  model L2
    extends L(o = 7, k = 9);
  end L2;
  model Q
    extends I;
    parameter Real p = 2;
  equation
    y = k*time^p + 1;
  end Q;
  model H
    replaceable model R = L(o = 2) constrainedby I(k = 2);
    R r;
  end H;
  model HH
    H h[2](redeclare each model R = Q(p = 1), r(k = {5, 6}));
  end HH;
  model HE
    replaceable H x constrainedby H;
  end HE;
  model Wrap
    replaceable model R = L constrainedby I;
    H inside(redeclare model R = R(k = 12));
  end Wrap;
  model Plain "no constraint: the modifiers of its own declaration"
    replaceable model R = L(o = 5, k = 1);
    R r;
  end Plain;
  model Nested
    replaceable model R = N constrainedby N(s(k = 2, o = 3));
    R r;
  end Nested;
  model N
    L s;
  end N;
  model Top
    H a;
    H b(redeclare model R = Q(k = 3));
    H c(redeclare model R = Q(p = 0), r(k = 1.5));
    HH d;
    HE e(redeclare H x(redeclare model R = L(o = 5.5)));
    Wrap g(redeclare replaceable model R = L(o = 2));
    Plain i(redeclare model R = L2);
    Nested j(redeclare model R = N(s(o = 1)));
  end Top;
end P;
