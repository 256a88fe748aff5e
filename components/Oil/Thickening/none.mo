within Oil.Thickening;
function none "Viscosity independent of pressure"
  extends Oil.Thickening.Law;
algorithm
  mu := mu_0;
  annotation(Inline = true);
end none;
