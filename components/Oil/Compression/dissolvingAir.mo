within Oil.Compression;
function dissolvingAir "Oil with air that dissolves at once as the pressure rises, all of it at p_sat"
  extends Oil.Compression.Law;
  input SI.BulkModulus beta_0(min = 1e6) = 1.5e9 "Tangent bulk modulus of the air-free oil at p_0";
  input Real m(unit = "1", min = 0.1) = 10 "Growth of the bulk modulus with pressure";
  input Real alpha_0(unit = "1") = 0.01 "Share of free air at p_0";
  input Real n_g(unit = "1") = 1.0 "Polytropic exponent of the bubbles";
  input SI.Pressure p_sat = 3e6 "Pressure at which all air is dissolved";
  input SI.Pressure p_v = 0 "Pressure that is not reached however far the oil is drawn apart";
  input SI.Pressure w_v = 1e3 "Fall of the pressure over which voids grow to e times their volume";
protected
  SI.Pressure p_s "Pressure of the bubbles: they grow no more where voids are a thousand times the oil";
  Real v_v "Volume of voids over the volume of the air-free oil at p_0";
  Real x "Modulus of the oil over its value at p_0";
  Real u "Place between p_0 and p_sat, 0 to 1";
  Real x_eq "Undissolved share in equilibrium";
  Real v_l "Volume of the oil over the volume of the air-free oil at p_0";
  Real r "Volume of a bubble over that at p_0";
algorithm
  p_s := max(p, p_v + 2*w_v);
  x := max(1 + m*(p - p_0)/beta_0, 1e-3);
  u := min(max((p - p_0)/(p_sat - p_0), 0), 1);
  x_eq := 1 - u*u*(3 - 2*u);
  r := (p_0/p_s)^(1/n_g);
  v_l := (1 - alpha_0)*x^(-1/m);
  v_v := exp(min((p_v - p)/w_v, 0) + 10)*(1 + max((p_v - p)/w_v, 0));
  rho := rho_0/(v_l + alpha_0*x_eq*r + v_v);
  beta := (v_l + alpha_0*x_eq*r + v_v)/(v_l/(beta_0*x) + alpha_0*x_eq*r/(n_g*p_s) + alpha_0*r*6*u*(1 - u)/(p_sat - p_0) + exp(min((p_v - p)/w_v, 0) + 10)/w_v);
  w := (1 - alpha_0)*beta_0/rho_0*(if abs(m - 1) > 1e-6 then (x^(1 - 1/m) - 1)/(m - 1) else log(x)) - w_v*v_v/rho_0;
  annotation(Inline = true, Documentation(info = "<html>
<p>As <code>entrainedAir</code>, with the undissolved share <code>x_eq(p)</code> falling smoothly from 1 at p_0 to 0 at p_sat. The last term of the modulus is the air that
goes into solution: it makes the oil softer in the transition. The argument <code>x_u</code> is not used. Suitable for slow processes only;
dissolving takes seconds to minutes. The work <code>w</code> leaves the bubbles out, which is some 5 J/kg, or 3 mK. Voids as in <code>entrainedAir</code>. Source: Henry's law for the equilibrium, its transition rounded; the modulus is the exact derivative.</p></html>"));
end dissolvingAir;
