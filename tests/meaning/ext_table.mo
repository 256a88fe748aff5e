//! model P.M
//! stop 3
//! y(0.51) = 1.02
//! y(1.89) = 2.89
//! y2(0.51) = 1
//! y2(1.89) = 4
//! z(2.67) = 2.5
package P "Interpolation in functions"
  function lin
    input Real xs[:];
    input Real ys[size(xs, 1)];
    input Real x;
    output Real y;
  protected
    Integer i = 1;
  algorithm
    assert(size(xs, 1) > 1, "too short");
    while i < size(xs, 1) - 1 and x >= xs[i + 1] loop
      i := i + 1;
    end while;
    y := ys[i] + (ys[i + 1] - ys[i])*(x - xs[i])/(xs[i + 1] - xs[i]);
  end lin;
  function bilin
    input Real T[:, :] "first row and column hold the grid";
    input Real u;
    input Real v;
    output Real y;
  protected
    Integer i = 2;
    Integer j = 2;
    Real a;
    Real b;
  algorithm
    while i < size(T, 1) - 1 and u > T[i + 1, 1] loop
      i := i + 1;
    end while;
    while j < size(T, 2) - 1 and v > T[1, j + 1] loop
      j := j + 1;
    end while;
    a := (u - T[i, 1])/(T[i + 1, 1] - T[i, 1]);
    b := (v - T[1, j])/(T[1, j + 1] - T[1, j]);
    y := (1 - a)*((1 - b)*T[i, j] + b*T[i, j + 1]) + a*((1 - b)*T[i + 1, j] + b*T[i + 1, j + 1]);
  end bilin;
  model M
    parameter Real tab[:, 2] = [0, 0; 1, 2; 2, 3; 3, 0];
    Real y = lin(tab[:, 1], tab[:, 2], time);
    discrete Real y2(start = 1, fixed = true);
    Real z = bilin([0, 0, 1; 0, 1, 2; 1, 3, 4], 0.5, 0.5);
    Integer k(start = 1, fixed = true);
  equation
    when sample(1, 1) then
      k = pre(k) + 1;
      y2 = k^2;
    end when;
  end M;
end P;
