within Oil.Viscosity;
function constantViscosity "Viscosity independent of temperature"
  extends Oil.Viscosity.Law;
  input SI.DynamicViscosity mu_ref = 0.04 "Dynamic viscosity";
algorithm
  mu := mu_ref;
  annotation(Inline = true, Documentation(info = "<html><p>For circuits of one temperature.</p></html>"));
end constantViscosity;
