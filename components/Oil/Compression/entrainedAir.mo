within Oil.Compression;
function entrainedAir "Oil with entrained air whose undissolved share is frozen"
  extends Oil.Compression.Law;
  input SI.BulkModulus beta_0(min = 1e6) = 1.5e9 "Tangent bulk modulus of the air-free oil at p_0";
  input Real m(unit = "1", min = 0.1) = 10 "Growth of the bulk modulus with pressure";
  input Real alpha_0(unit = "1") = 0.01 "Share of free air at p_0";
  input Real n_g(unit = "1") = 1.2 "Polytropic exponent of the bubbles";
  input SI.Pressure p_v = 0 "Pressure that is not reached however far the oil is drawn apart";
  input SI.Pressure w_v = 1e3 "Fall of the pressure over which voids grow to e times their volume";
protected
  SI.Pressure p_s "Pressure of the bubbles: they grow no more where voids are a thousand times the oil";
  Real x "Modulus of the oil over its value at p_0";
  Real v_l "Volume of the oil over the volume of the air-free oil at p_0";
  Real v_g "Volume of the undissolved air, likewise";
  Real v_v "Volume of voids, likewise";
algorithm
  p_s := max(p, p_v + 2*w_v);
  x := max(1 + m*(p - p_0)/beta_0, 1e-3);
  v_l := (1 - alpha_0)*x^(-1/m);
  v_g := alpha_0*max(x_u, 0)*(p_0/p_s)^(1/n_g);
  v_v := exp(min((p_v - p)/w_v, 0) + 10)*(1 + max((p_v - p)/w_v, 0));
  rho := rho_0/(v_l + v_g + v_v);
  beta := (v_l + v_g + v_v)/(v_l/(beta_0*x) + v_g/(n_g*p_s) + exp(min((p_v - p)/w_v, 0) + 10)/w_v);
  w := (1 - alpha_0)*beta_0/rho_0*(if abs(m - 1) > 1e-6 then (x^(1 - 1/m) - 1)/(m - 1) else log(x))
    + alpha_0*max(x_u, 0)*p_0/rho_0*(if abs(n_g - 1) > 1e-6 then ((p_s/p_0)^(1 - 1/n_g) - 1)/(1 - 1/n_g) else log(p_s/p_0)) - w_v*v_v/rho_0;
  annotation(Inline = true, Documentation(info = "<html>
<p>Volume of oil and of bubbles added, <code>v = (1 - alpha_0) (1 + m (p - p_0)/beta_0)^(-1/m) + alpha_0 x_u (p_0/p)^(1/n_g)</code>, the bulk modulus
being its exact logarithmic derivative. The mass of the air is neglected. 1 % of frozen air gives 0.012, 0.196, 0.992, 1.407 and
1.684 GPa at 0.1, 0.5, 2, 5 and 20 MPa. Oil that is drawn apart opens voids of the volume <code>exp(10 - (p - p_v)/w_v)</code>: a hundredth at 14.6 kPa, as much as the oil at 10 kPa, twenty thousand times as much at <code>p_v</code>. So no circuit comes to a pressure
below <code>p_v</code>, mass is conserved while a void opens and closes, and above 25 kPa there is none. The width is what a solver resolves: at a tolerance of 1e-6 the mass of a chamber that is drawn to ten times its volume is right to a hundredth, at 1e-8 to some ten thousandths. What is vapour in it and what air that comes out of solution is left open.</p>
<p>Exponent: 1.0 for slow, 1.2 for usual, 1.4 for fast processes. Source: family of compression-only mixtures (Wylie, Cho, Nykaenen), see
S. Kim and H. Murrenhoff, J. Fluids Eng. 134 (2012) 021201.</p></html>"));
end entrainedAir;
