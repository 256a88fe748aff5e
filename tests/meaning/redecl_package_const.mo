//! model P.M
//! a.p(0.17) = 0.68
//! a.p(0.63) = 2.52
//! b.p(0.17) = 2.04
//! b.p(0.63) = 7.56
//! b.q(0.89) = 2
//! c.p(0.17) = 5.1
//! c.p(0.63) = 18.9
package P
  partial package PM
    constant Integer n;
    constant Real k[n];
    replaceable partial function f
      input Real x;
      output Real y;
    end f;
    replaceable record State
      Real p;
    end State;
  end PM;
  package A
    extends PM(n = 2, k = {1, 3});
    redeclare function extends f
    algorithm
      y := sum(k)*x;
    end f;
  end A;
  package B
    extends PM(n = 3, k = {3, 4, 5});
    redeclare function f
      input Real x;
      output Real y;
    algorithm
      y := x*(k[1] + k[2] + k[end]);
    end f;
    redeclare record extends State
      Real q;
    end State;
  end B;
  model U
    replaceable package Med = A constrainedby PM;
    Med.State s(p = Med.f(time));
    Real p = s.p;
  end U;
  model UB
    extends U(redeclare package Med = B, s(q = 2));
    Real q = s.q;
  end UB;
  package C = A(k = {10, 20});
  model M
    U a;
    UB b;
    U c(redeclare package Med = C);
  end M;
end P;
