//! model P.M
//! a(1) = 2
//! b(1) = 7
// one class is inherited on two ways, with the same replaceable class and the same final modifier on both
package P
  partial model Medium
    parameter Real d = 1;
  end Medium;
  model Water
    extends Medium(d = 2);
  end Water;
  partial model Root
    parameter Real k = 3;
    replaceable model M = Medium;
  end Root;
  partial model Left
    extends Root(final k = 7);
    replaceable model Other = Medium;
  end Left;
  partial model Right
    extends Root(final k = 7);
    replaceable model Other = Medium;
  end Right;
  model Both
    extends Left;
    extends Right;
    M m;
    Real a = m.d*time;
    Real b = k*time;
  end Both;
  model M
    Both both(redeclare model M = Water);
    Real a = both.a;
    Real b = both.b;
  end M;
end P;
