//! model P.M
//! y(0) = 5
//! z(1) = 10
// a package modifies one of its types: each element of an array of that type takes the modifiers
package P
  partial package Media
    type Density = Real;
  end Media;
  package Oil
    extends Media(Density(start = 5, nominal = 10));
  end Oil;
  model M
    replaceable package Medium = Oil;
    Medium.Density d[2];
    Real y = d[1];
    Real z = d[1] + d[2];
  initial equation
    d[1] = 5;
    d[2] = 5;
  equation
    der(d) = zeros(2);
  end M;
end P;
