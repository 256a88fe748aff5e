//! model P.M
//! r[1].i(0.17) = 0.17
//! r[1].i(0.63) = 0.63
//! r[4].i(0.17) = 0.0425
//! r[4].i(0.63) = 0.1575
//! tot(0.17) = 0.354166666667
//! tot(0.63) = 1.3125
package P
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  model R
    Pin p, n;
    parameter Real R = 1;
    Real i = p.i;
  equation
    p.v - n.v = R*i;
    p.i + n.i = 0;
  end R;
  model Src
    Pin p[2, 2];
  equation
    for i in 1:2, j in 1:2 loop
      p[i, j].v = 2*time;
    end for;
  end Src;
  model G
    Pin p;
    parameter Real v = 0;
    Real i = p.i;
  equation
    p.v = time;
  end G;
  model M
    Src s;
    R r[4](R = 1:4);
    G g;
    Real tot = g.i;
  equation
    for i in 1:2, j in 1:2 loop
      connect(s.p[i, j], r[2*(i - 1) + j].p);
    end for;
    for k in 1:4 loop
      connect(r[k].n, g.p);
    end for;
  end M;
end P;
