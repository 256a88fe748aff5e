//! model P.M
//! size_of(1) = 5
//! plain(1) = 4
//! doubled(1) = 8
// an imported function bears the name of a built-in one and is nearer
package P
  package Other
    function abs
      input Real x[2];
      output Real y;
    algorithm
      y := sqrt(x[1]^2 + x[2]^2);
    end abs;
    function exp
      input Real x;
      output Real y;
    algorithm
      y := 2*x;
    end exp;
  end Other;
  model Here
    import P.Other.abs;
    import P.Other.exp;
    Real size_of = abs({3, 4*time});
    Real doubled = exp(4*time);
  end Here;
  model M
    Here here;
    Real size_of = here.size_of;
    Real doubled = here.doubled;
    Real plain = abs(-4*time);
  end M;
end P;
