within Hydraulic.Functions;
function modulus "Tangent bulk modulus of oil with entrained air"
  input SI.Pressure p "Absolute pressure";
  input SI.Pressure p_0 "Reference pressure";
  input SI.BulkModulus beta_0 "Modulus of the air-free oil at p_0";
  input Real m "Growth of the modulus with pressure";
  input Real alpha "Undissolved air at p_0, share of volume";
  input Real n_g "Polytropic exponent";
  output SI.BulkModulus beta "Tangent modulus";
protected
  Real x, v_l, v_g;
  SI.Pressure p_s;
algorithm
  p_s := max(p, 1e3);
  x := 1 + m*(p_s - p_0)/beta_0;
  v_l := (1 - alpha)*x^(-1/m);
  v_g := alpha*(p_0/p_s)^(1/n_g);
  beta := (v_l + v_g)/(v_l/(beta_0*x) + v_g/(n_g*p_s));
  annotation(Inline = true, Documentation(info = "<html><p>Tangent modulus of oil with frozen air: volume over its derivative by pressure, <code>(v_l + v_g)/(v_l/beta_l + v_g/(n_g p))</code>, both parts referred to p_0. Source: E. B. Wylie and V. L. Streeter, Fluid Transients in Systems, 1993.</p></html>"));
end modulus;
