//! model P.M
//! y(0.17) = 1.51
//! y(0.63) = 2.89
//! b.y(0.17) = 0.34
//! b.y(0.63) = 1.26
//! k(0.89) = 4
package P
  block B
    input Real u = time;
    output Real y = 2*u;
  end B;
  model M
    input Real u(start = 1) = 3*time + 1;
    output Real y = u;
    B b;
    input Integer n = 4;
    output Integer k = n;
    input Boolean free(start = true);
    input Real w = 0;
  end M;
end P;
