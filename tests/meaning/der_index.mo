//! y(0.17) = 1.88550933106
//! y(0.63) = 0.611633816757
//! a(0.17) = -1.33394836856
//! a(0.63) = -3.80836136636
//! F(0.17) = -4.00184510569
//! F(0.63) = -11.4250840991
//! z(0.17) = 0.330209450861
//! z(0.63) = 0.784283106046
//! q[2](0.89) = 2
model M "index reduction through arrays and der of products"
  Real x = sin(2*time);
  Real y = der(x);
  Real a;
  Real F;
  Real v;
  Real z = der(cos(time)*time^2);
  Real r[2] = {time, 2*time};
  Real q[2] = der(r);
equation
  v = der(x);
  a = der(v);
  3*a = F;
end M;
