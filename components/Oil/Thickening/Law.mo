within Oil.Thickening;
partial function Law "What a law of thickening takes and gives"
  input SI.DynamicViscosity mu_0 "Dynamic viscosity at low pressure";
  input SI.Pressure p "Pressure above the surroundings; in a gap the mean pressure of the film";
  output SI.DynamicViscosity mu(nominal = 0.03) "Dynamic viscosity at that pressure";
  annotation(Documentation(info = "<html><p>Choices: <code>none</code>, <code>barus</code>, <code>roelands</code>.</p></html>"));
end Law;
