//! E010 at 10: "`C` has no class `A`"
//! E010 at 10: "`C.A` has no class `A`"
//! E014 at 11: "look for them inside each other: T.B.A"
//! E010 at 28: "`B.A` has no class `A`"
//! E027 at 27: "a model cannot extend a package"
//! model T.M
package T
  package B
    extends B.A(redeclare package B = B.D);
    package A = C.A.A(redeclare package C = A.B.D);
    package C
      extends B;
      import C.C.A.*;
      model D
        A x;
      end D;
    end C;
  end B;
  package C
    package A
      extends C.B(redeclare package B = D.D.C);
      import D = A;
    end A;
  end C;
  package A = B.C;
  model M
    extends C;
    B.A.A y;
    Real x = 1;
  end M;
end T;
