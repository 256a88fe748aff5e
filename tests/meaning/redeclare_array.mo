//! model P.M
//! h.x[1].y(0.17) = 0.843664816596
//! h.x[1].y(0.63) = 0.532591801007
//! h.x[3].y(0.17) = 0.600495578812
//! h.x[3].y(0.63) = 0.151071808836
//! g.x[2].y(0.17) = 0.942754665528
//! g.x[2].y(0.63) = 0.305816908378
//! tot(0.17) = 2.15593071817
//! tot(0.63) = 0.967317636343
package P
  partial model Base
    parameter Real w = 1;
    Real y(start = 1, fixed = true);
  end Base;
  model Decay
    extends Base;
  equation
    der(y) = -w*y;
  end Decay;
  model Osc
    extends Base;
    Real v(start = 0, fixed = true);
  equation
    der(y) = v;
    der(v) = -w^2*y;
  end Osc;
  model Holder
    parameter Integer n = 3;
    replaceable model X = Decay constrainedby Base;
    X x[n](w = {i for i in 1:n});
  end Holder;
  model M
    Holder h;
    Holder g(redeclare model X = Osc, n = 2);
    Real tot = sum(h.x.y);
  end M;
end P;
