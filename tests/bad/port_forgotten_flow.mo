//! W107 at 4: "has 2 more potentials than flows"
//! model P.M
package P
  connector Pin
    Real v;
    Real i;
  end Pin;
  model Resistor
    Pin p, n;
    parameter Real R = 1;
  equation
    p.v - n.v = R*p.i;
    p.i = n.i;
  end Resistor;
  model Source
    Pin p;
  equation
    p.v = 1;
  end Source;
  model Ground
    Pin p;
  equation
    p.v = 0;
  end Ground;
  model M
    Resistor r;
    Source s;
    Ground g;
  equation
    connect(s.p, r.p);
    connect(r.n, g.p);
  end M;
end P;
