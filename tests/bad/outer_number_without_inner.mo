//! E016 at 5: "`outer g` finds no `inner g`"
//! model P.M
package P
  model A
    outer Real g;
    Real y = g;
  end A;
  model M
    A a;
  end M;
end P;
