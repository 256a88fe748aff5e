//! E027 at 13: "`A` is replaceable and cannot be a base class"
//! E014 at 9: "look for them inside each other: T.B.B"
//! E024 at 14: "`T.B.B` is a package"
//! model T.M
// each constraint lies in a class that the next redeclaration of the same class makes
package T
  package B
    replaceable package C = A;
    replaceable package B = C.B.D;
  end B;
  replaceable package A = B(redeclare package B = B.C);
  model M
    extends A;
    B y;
    Real x = 1;
  end M;
end T;
