within Oil.Thickening;
function barus "Barus' law: mu = mu_0 exp(alpha_p p)"
  extends Oil.Thickening.Law;
  input Real alpha_p(unit = "1/Pa", min = 0, max = 5e-8) = 2e-8 "Pressure coefficient";
algorithm
  mu := mu_0*exp(alpha_p*p);
  annotation(Inline = true, Documentation(info = "<html><p>Good to some 50 MPa; too stiff beyond. Source: C. Barus, Am. J. Sci. 45 (1893) 87.</p></html>"));
end barus;
