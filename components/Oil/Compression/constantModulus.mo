within Oil.Compression;
function constantModulus "Constant bulk modulus: rho = rho_0 exp((p - p_0)/beta_0)"
  extends Oil.Compression.Law;
  input SI.BulkModulus beta_0(min = 1e6) = 1.4e9 "Bulk modulus";
algorithm
  rho := rho_0*exp((p - p_0)/beta_0);
  beta := beta_0;
  w := beta_0/rho_0*(1 - exp(-(p - p_0)/beta_0));
  annotation(Inline = true, Documentation(info = "<html><p>Integral of d rho/rho = dp/beta. No lower limit of the pressure: tension in the oil is not excluded.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 2.4. Valid where the modulus changes little: some 10 MPa about a level.</p></html>"));
end constantModulus;
