within Oil.Compression;
function constantDensity "Textbook form: constant density and constant bulk modulus at the same time"
  extends Oil.Compression.Law;
  input SI.BulkModulus beta_0(min = 1e6) = 1.4e9 "Bulk modulus";
algorithm
  rho := rho_0;
  beta := beta_0;
  annotation(Inline = true, Documentation(info = "<html><p>Volume flows balance instead of masses, as in most textbooks: the oil that compression stores is not carried along, an error of dp/beta. For comparison with such models;
<code>constantModulus</code> is the same oil with consistent density. Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 2.</p></html>"));
end constantDensity;
