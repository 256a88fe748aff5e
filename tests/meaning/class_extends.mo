//! model P.M
//! m.z(0.17) = 0.85
//! m.z(0.63) = 3.15
//! m.w(0.17) = 1.85
//! m.w(0.63) = 4.15
//! y(0.17) = 0.51
//! y(0.63) = 1.89
//! u.w(0.17) = 1.34
//! u.w(0.63) = 2.26
//! r(0.89) = 7
//! d.w(0.17) = 1.34
//! d.w(0.63) = 2.26
//! d.v(0.17) = 2.68
//! d.v(0.63) = 4.52
package P
  partial package PM
    replaceable function f
      input Real x;
      output Real y;
    end f;
    replaceable model Mo
      parameter Real k = 2;
      Real z = k*time;
    end Mo;
    replaceable record R
      Real a = 3;
    end R;
  end PM;
  package A
    extends PM;
    redeclare function extends f
    algorithm
      y := 3*x;
    end f;
    redeclare replaceable model extends Mo
      Real w = z + 1;
    end Mo;
    redeclare record extends R(a = 4)
      Real b = 3;
    end R;
    model User
      extends Mo;
    end User;
  end A;
  package B
    extends A;
    redeclare model extends Mo
      Real v = 2*w;
    end Mo;
  end B;
  model M
    Real y = A.f(time);
    A.Mo m(k = 5);
    A.User u;
    A.R rec;
    Real r = rec.a + rec.b;
    B.Mo d;
  end M;
end P;
