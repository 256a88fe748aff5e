//! model P.M
//! c.r.y[2](0.17) = 0.34
//! c.r.y[2](0.63) = 1.26
//! c.r.z(0.17) = 1.02
//! c.r.z(0.63) = 3.78
package P
  partial block B
    parameter Integer n = 1;
    output Real y[n];
  end B;
  block B1
    extends B(final n = 3);
    output Real z = sum(y);
  equation
    y = {i*time for i in 1:n};
  end B1;
  block C
    replaceable block T = B1 constrainedby B;
    T r;
  end C;
  model M
    C c;
  end M;
end P;
