//! model P.M
//! stop 0.1
//! tolerance 2e-3
//! load.v(0.017) = 8.09016994375
//! load.v(0.063) = 8.09016994375
package P
  connector Pin
    Real v(unit = "V");
    flow Real i(unit = "A");
  end Pin;
  partial model TwoPin
    Pin p, n;
    Real v(unit = "V") = p.v - n.v;
    Real i(unit = "A") = p.i;
  equation
    p.i + n.i = 0;
  end TwoPin;
  model Diode "ideal"
    extends TwoPin;
    parameter Real Ron = 1e-5;
    parameter Real Goff = 1e-5;
    Boolean off(start = true);
    Real s;
  equation
    off = s < 0;
    v = s*(if off then 1 else Ron);
    i = s*(if off then Goff else 1);
  end Diode;
  model R
    extends TwoPin;
    parameter Real R = 100;
  equation
    v = R*i;
  end R;
  model Sine
    extends TwoPin;
  equation
    v = 10*sin(6.283185307179586*50*time);
  end Sine;
  model G
    Pin p;
  equation
    p.v = 0;
  end G;
  model M
    Sine s;
    Diode d[4];
    R load;
    G g;
  equation
    connect(s.p, d[1].p);
    connect(s.p, d[2].n);
    connect(s.n, d[3].p);
    connect(s.n, d[4].n);
    connect(d[1].n, load.p);
    connect(d[3].n, load.p);
    connect(d[2].p, load.n);
    connect(d[4].p, load.n);
    connect(s.n, g.p);
  end M;
end P;
