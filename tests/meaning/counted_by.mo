//! model P.M
//! last(0.5) = 3
//! second(0.5) = 2
//! swapped[1](0.5) = 5
//! swapped[2](0.5) = 4
//! total(0.5) = 6
//! yes(0.5) = 5
//! w[2](0.5) = 2
package P "arrays that count by an enumeration or by truth values"
  type Color = enumeration(red, green, blue);
  function green
    input Real w[Color];
    output Real y;
  algorithm
    y := w[Color.green];
  end green;
  model M
    parameter Color middle = Color.green;
    Real w[Color];
    Real z[Boolean] = {4, 5};
    Real last = w[end];
    Real second = green(w) + w[middle] - 2;
    Real swapped[2] = z[{true, false}];
    Real total = sum(w[c] for c);
    Real yes = z[end];
  equation
    for c loop
      w[c] = Integer(c);
    end for;
  end M;
end P;
