within Oil.Compression;
function linearModulus "Bulk modulus linear in pressure: rho = rho_0 (1 + m (p - p_0)/beta_0)^(1/m)"
  extends Oil.Compression.Law;
  input SI.BulkModulus beta_0(min = 1e6) = 1.5e9 "Tangent bulk modulus at p_0";
  input Real m(unit = "1", min = 0.1) = 10 "Growth of the bulk modulus with pressure";
protected
  Real x "Modulus over its value at p_0";
algorithm
  x := max(1 + m*(p - p_0)/beta_0, 1e-3);
  rho := rho_0*x^(1/m);
  beta := beta_0*x;
  w := beta_0/rho_0*(if abs(m - 1) > 1e-6 then (x^(1 - 1/m) - 1)/(m - 1) else log(x));
  annotation(Inline = true, Documentation(info = "<html><p>Murnaghan's equation of state; m is about 10 for mineral oils. Valid to some 100 MPa.
Source: F. D. Murnaghan, Proc. Natl. Acad. Sci. 30 (1944) 244.</p></html>"));
end linearModulus;
