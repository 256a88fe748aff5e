within Oil.Thickening;
function roelands "Roelands' law: mu = mu_0 exp((ln mu_0 + 9.67)((1 + 5.1e-9 p)^Z - 1))"
  extends Oil.Thickening.Law;
  input Real Z(unit = "1", min = 0.1, max = 1) = 0.6 "Exponent of the oil";
algorithm
  mu := mu_0*exp((log(mu_0) + 9.67)*((1 + 5.1e-9*max(p, -1e8))^Z - 1));
  annotation(Inline = true, Documentation(info = "<html><p>mu_0 in Pa.s, p in Pa. Good to some 500 MPa. Source: C. J. A. Roelands, dissertation, Delft 1966.</p></html>"));
end roelands;
