within Oil.Thickening;
function none "Viscosity independent of pressure"
  extends Oil.Thickening.Law;
algorithm
  mu := mu_0;
  annotation(Inline = true, Documentation(info = "<html><p>Viscosity does not depend on pressure: right below some 10 MPa.</p></html>"));
end none;
