within Oil.Viscosity;
partial function Law "What a law of viscosity takes and gives"
  input SI.Temperature T "Temperature";
  output SI.DynamicViscosity mu(nominal = 0.03) "Dynamic viscosity at low pressure";
  annotation(Documentation(info = "<html><p>Choices: <code>constantViscosity</code>, <code>exponential</code>, <code>astmD341</code>.</p></html>"));
end Law;
