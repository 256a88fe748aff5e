//! model P.M
//! stop 5
//! tolerance 1e-4
//! drain.h(1) = 0.25
//! drain.h(3) = 0
//! level.p1(5) = 1
//! level.p2(5) = 1
//! power.x(5) = -1.5
// What a relation keeps from falling below 0 is a root that ends where the relation turns.
package P
  model Drain
    Real h(start = 1, fixed = true), q;
  equation
    der(h) = -q;
    q = if h > 0 then sqrt(h) else 0;
  end Drain;
  model Level
    Real p1(start = 2, fixed = true), p2(start = 0, fixed = true), q;
  equation
    der(p1) = -q;
    der(p2) = q;
    q = if p1 > p2 then sqrt(p1 - p2) else -sqrt(p2 - p1);
  end Level;
  model Power
    Real x(start = 1, fixed = true), y, z(start = 0, fixed = true);
  equation
    der(x) = -0.5;
    y = if x > 0 and z > -1 then x^1.5 else 0;
    der(z) = y;
  end Power;
  model M
    Drain drain;
    Level level;
    Power power;
  end M;
end P;
