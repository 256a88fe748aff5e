//! model P.M
//! x[3](0.5) = 1.5
//! s(0.5) = 7.5
//! d[4](0.5) = 3
//! r[1](0.5) = 2
//! q(0.5) = 2
//! c[2].y[3](0.5) = 1.5
package P "loops without a range run over the array that they index"
  function rev
    input Real v[:];
    output Real w[size(v, 1)];
  algorithm
    for i loop
      w[i] := v[size(v, 1) + 1 - i];
    end for;
  end rev;
  model C
    Real y[3];
  equation
    for i loop
      y[i] = i*time;
    end for;
  end C;
  model M
    Real x[4];
    Real s = sum(x[i]^2 for i);
    Real d[4] = {x[i] + 1 for i};
    C c[2];
    Real r[4] = rev(x);
    Real q = sum(c[j].y[2] for j);
  equation
    for i loop
      x[i] = i*time;
    end for;
  end M;
end P;
