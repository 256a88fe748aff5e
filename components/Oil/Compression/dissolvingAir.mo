within Oil.Compression;
function dissolvingAir "Oil with air that dissolves at once as the pressure rises, all of it at p_sat"
  extends Oil.Compression.Law;
  input SI.BulkModulus beta_0(min = 1e6) = 1.5e9 "Tangent bulk modulus of the air-free oil at p_0";
  input Real m(unit = "1", min = 0.1) = 10 "Growth of the bulk modulus with pressure";
  input Real alpha_0(unit = "1") = 0.01 "Share of free air at p_0";
  input Real n_g(unit = "1") = 1.0 "Polytropic exponent of the bubbles";
  input SI.Pressure p_sat = 3e6 "Pressure at which all air is dissolved";
  input SI.Pressure p_w = 5e3 "Width of the vapour floor";
protected
  Real a "Share of air, a millionth at least: nuclei from which a void opens";
  SI.Pressure p_s "Pressure with a floor at 0";
  Real floor_slope "d p_s/d p";
  Real x "Modulus of the oil over its value at p_0";
  Real u "Place between p_0 and p_sat, 0 to 1";
  Real x_eq "Undissolved share in equilibrium";
  Real v_l "Volume of the oil over the volume of the air-free oil at p_0";
  Real r "Volume of a bubble over that at p_0";
algorithm
  a := max(alpha_0, 1e-6);
  p_s := max(p, 0) + p_w*(log(1 + exp(-abs(p)/p_w)) + 1e-6);
  floor_slope := 1/(1 + exp(min(-p/p_w, 200)));
  x := max(1 + m*(p_s - p_0)/beta_0, 1e-3);
  u := min(max((p_s - p_0)/(p_sat - p_0), 0), 1);
  x_eq := 1 - u*u*(3 - 2*u);
  r := (p_0/p_s)^(1/n_g);
  v_l := (1 - a)*x^(-1/m);
  rho := rho_0/(v_l + a*x_eq*r);
  beta := (v_l + a*x_eq*r)/((v_l/(beta_0*x) + a*x_eq*r/(n_g*p_s) + a*r*6*u*(1 - u)/(p_sat - p_0))*floor_slope);
  w := (1 - a)*beta_0/rho_0*(if abs(m - 1) > 1e-6 then (x^(1 - 1/m) - 1)/(m - 1) else log(x));
  annotation(Inline = true, Documentation(info = "<html>
<p>As <code>entrainedAir</code>, with the undissolved share <code>x_eq(p)</code> falling smoothly from 1 at p_0 to 0 at p_sat. The last term of the modulus is the air that
goes into solution: it makes the oil softer in the transition. The argument <code>x_u</code> is not used. Suitable for slow processes only;
dissolving takes seconds to minutes. The work <code>w</code> leaves the bubbles out, which is some 5 J/kg, or 3 mK. Source: Henry's law for the equilibrium, its transition rounded; the modulus is the exact derivative.</p></html>"));
end dissolvingAir;
