within Oil.Compression;
partial function Law "What a law of density takes and gives"
  input SI.Pressure p "Absolute pressure";
  input SI.Density rho_0 = 860 "Density of the air-free oil at p_0";
  input SI.Pressure p_0 = 101325 "Reference pressure";
  input Real x_u(unit = "1") = 0.2 "Share of the air that is not dissolved";
  output SI.Density rho(nominal = 1000) "Density";
  output SI.BulkModulus beta(nominal = 1e9) "Tangent bulk modulus rho/(d rho/d p)";
  output SI.SpecificEnthalpy w(nominal = 1e4) = (p - p_0)/rho_0 "Integral of dp/rho from p_0: what it takes to push a kilogram in";
  output SI.Density rho_s(nominal = 1000) = 0 "Density by which volumes store, of modulus beta: rho_0 exp(integral of dp/beta); 0: rho, as of every law whose modulus belongs to its density";
  annotation(Documentation(info = "<html><p>A law returns density and tangent modulus together, so that volumes conserve mass; <code>x_u</code> is the undissolved share of the air. Where oil carries
heat, <code>w</code> is the part of its enthalpy that the pressure makes; a law that does not say it takes that of constant density.</p></html>"));
end Law;
