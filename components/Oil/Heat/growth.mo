within Oil.Heat;
function growth "Volume of oil at a temperature over that at T_0"
  input SI.Temperature T "Temperature";
  input SI.CubicExpansionCoefficient gamma = 7e-4 "Expansion per kelvin, over the volume at T_0";
  input SI.Temperature T_0 = 313.15 "Temperature at which the growth is 1";
  output Real y(unit = "1") "Volume over that at T_0";
algorithm
  y := 1 + gamma*(T - T_0);
  annotation(Inline = true, Documentation(info = "<html><p><code>1 + gamma (T - T_0)</code> at any pressure, which keeps the heat capacity free of the pressure: see <code>Oil.Heat</code>. Valid some 50 K about <code>T_0</code>.</p></html>"));
end growth;
