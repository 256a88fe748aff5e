within Oil.Heat;
function voidWork "What voids add to the integral of dp/rho from a pressure up to the lowest one without them"
  input SI.Pressure p "Absolute pressure";
  replaceable function law = Oil.Compression.constantDensity constrainedby Oil.Compression.Law "Law of compression";
  input SI.Pressure p_l = 25e3 "Lowest pressure without voids";
  input SI.Density rho_l = 860 "Density there";
  output SI.SpecificEnthalpy w(nominal = 1e3) "Work over that of oil of the density rho_l, not above 0";
protected
  SI.Density rho "Density at T_0";
  SI.BulkModulus beta "Tangent bulk modulus";
  SI.SpecificEnthalpy w_p "Integral of dp/rho from p_0";
  SI.SpecificEnthalpy w_l "The same at p_l";
algorithm
  (rho, beta, w_p) := law(min(p, p_l));
  (rho, beta, w_l) := law(p_l);
  w := w_p - w_l - (min(p, p_l) - p_l)/rho_l;
  annotation(Inline = true, Documentation(info = "<html><p>For losses between places of which one cavitates: with liquid they go by the mean density, in voids by the law itself. Source: integral of dp/rho.</p></html>"));
end voidWork;
