//! model P.M
//! r.i[2](0.17) = 0.34
//! r.i[2](0.63) = 1.26
//! r.tot(0.17) = 0.51
//! r.tot(0.63) = 1.89
package P "connector with array variables"
  connector Bus
    Real v[3];
    flow Real i[3];
  end Bus;
  model Src
    Bus b;
  equation
    b.v = {1, 2, 3}*time;
  end Src;
  model Res
    Bus b;
    parameter Real R[3] = {1, 1, 1};
    Real i[3] = b.i;
    Real tot = i[1] + i[2];
  equation
    b.v = R .* b.i;
  end Res;
  model M
    Src s;
    Res r;
  equation
    connect(s.b, r.b);
  end M;
end P;
