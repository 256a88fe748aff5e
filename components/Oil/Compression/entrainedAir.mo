within Oil.Compression;
function entrainedAir "Oil with entrained air whose undissolved share is frozen"
  extends Oil.Compression.Law;
  input SI.BulkModulus beta_0(min = 1e6) = 1.5e9 "Tangent bulk modulus of the air-free oil at p_0";
  input Real m(unit = "1", min = 0.1) = 10 "Growth of the bulk modulus with pressure";
  input Real alpha_0(unit = "1") = 0.01 "Share of free air at p_0";
  input Real n_g(unit = "1") = 1.2 "Polytropic exponent of the bubbles";
  input SI.Pressure p_w = 5e3 "Width of the vapour floor";
protected
  SI.Pressure p_s "Pressure with a floor at 0";
  Real floor_slope "d p_s/d p";
  Real x "Modulus of the oil over its value at p_0";
  Real v_l "Volume of the oil over the volume of the air-free oil at p_0";
  Real v_g "Volume of the undissolved air, likewise";
algorithm
  p_s := max(p, 0) + p_w*(log(1 + exp(-abs(p)/p_w)) + 1e-6);
  floor_slope := 1/(1 + exp(min(-p/p_w, 200)));
  x := max(1 + m*(p_s - p_0)/beta_0, 1e-3);
  v_l := (1 - alpha_0)*x^(-1/m);
  v_g := max(alpha_0*x_u, 1e-6)*(p_0/p_s)^(1/n_g);
  rho := rho_0/(v_l + v_g);
  beta := (v_l + v_g)/((v_l/(beta_0*x) + v_g/(n_g*p_s))*floor_slope);
  w := (1 - alpha_0)*beta_0/rho_0*(if abs(m - 1) > 1e-6 then (x^(1 - 1/m) - 1)/(m - 1) else log(x))
    + max(alpha_0*x_u, 1e-6)*p_0/rho_0*(if abs(n_g - 1) > 1e-6 then ((p_s/p_0)^(1 - 1/n_g) - 1)/(1 - 1/n_g) else log(p_s/p_0));
  annotation(Inline = true, Documentation(info = "<html>
<p>Volume of oil and of bubbles added, <code>v = (1 - alpha_0) (1 + m (p - p_0)/beta_0)^(-1/m) + alpha_0 x_u (p_0/p)^(1/n_g)</code>, the bulk modulus
being its exact logarithmic derivative. The mass of the air is neglected. 1 % of frozen air gives 0.012, 0.196, 0.992, 1.407 and
1.684 GPa at 0.1, 0.5, 2, 5 and 20 MPa. Below some kilopascal the pressure is floored (softplus of width <code>p_w</code>): the bubbles grow without limit instead
of the pressure becoming negative. A millionth of the volume always counts as bubbles: from such nuclei even oil without air opens a void when it is drawn apart.</p>
<p>Exponent: 1.0 for slow, 1.2 for usual, 1.4 for fast processes. Source: family of compression-only mixtures (Wylie, Cho, Nykaenen), see
S. Kim and H. Murrenhoff, J. Fluids Eng. 134 (2012) 021201.</p></html>"));
end entrainedAir;
