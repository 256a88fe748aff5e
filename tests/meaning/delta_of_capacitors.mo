//! model P.Delta
//! stop 10
//! c1.v(10) = 0
//! c2.v(10) = 0
//! s(10) = 0
// Three capacitors in a ring behind resistors: two are states, and all voltages end at 0 without a source between them.
package P
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  partial model Two
    Pin p, n;
    Real v, i;
  equation
    v = p.v - n.v;
    i = p.i;
    p.i + n.i = 0;
  end Two;
  model Capacitor
    extends Two;
    parameter Real C = 0.01;
  equation
    C*der(v) = i;
  end Capacitor;
  model Resistor
    extends Two;
    parameter Real R = 1;
  equation
    R*i = v;
  end Resistor;
  model Ground
    Pin p;
  equation
    p.v = 0;
  end Ground;
  model Delta
    Capacitor c1(v(start = 3, fixed = true)), c2(C = 0.02, v(start = -1, fixed = true)), c3(C = 0.03);
    Resistor r1, r2(R = 2), r3(R = 3);
    Ground g;
    Real s = c1.v + c2.v + c3.v;
  equation
    connect(c1.n, c2.p);
    connect(c2.n, c3.p);
    connect(c3.n, c1.p);
    connect(r1.p, c1.p);
    connect(r2.p, c2.p);
    connect(r3.p, c3.p);
    connect(r1.n, g.p);
    connect(r2.n, g.p);
    connect(r3.n, g.p);
  end Delta;
end P;
