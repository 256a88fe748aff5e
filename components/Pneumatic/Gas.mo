within Pneumatic;
model Gas "Gas of the circuit: ideal, of constant heat capacity"
  parameter SI.SpecificHeatCapacity R_s(min = 50, max = 5000, nominal = 300) = 288 "Specific gas constant";
  parameter Real kappa(unit = "1", min = 1.01, max = 1.67) = 1.4 "Ratio of the heat capacities c_p/c_v";
  parameter SI.Pressure p_0(min = 1e4, max = 1e6, nominal = 1e5, displayUnit = "bar") = 1e5 "Pressure of the reference atmosphere, also of the surroundings";
  parameter SI.Temperature T_0(min = 220, max = 420, nominal = 300, displayUnit = "degC") = 293.15 "Temperature of the reference atmosphere, also of the surroundings";
  final parameter SI.SpecificHeatCapacity c_p(min = 1, nominal = 1000) = kappa*R_s/(kappa - 1) "Heat capacity at constant pressure";
  final parameter SI.SpecificHeatCapacity c_v(min = 1, nominal = 1000) = R_s/(kappa - 1) "Heat capacity at constant volume";
  final parameter SI.Density rho_0(min = 1e-3, nominal = 1) = p_0/(R_s*T_0) "Density at p_0 and T_0";
equation
  assert(R_s > 0, "The gas constant R_s must be positive");
  assert(kappa > 1, "The ratio of the heat capacities kappa must lie above 1");
  assert(p_0 > 0 and T_0 > 0, "The pressure p_0 and the temperature T_0 of the reference atmosphere must be positive");
  annotation(
    defaultComponentName = "gas",
    defaultComponentPrefixes = "inner",
    missingInnerMessage = "No gas is declared: air with the reference atmosphere of 100 kPa and 20 degC is used. Declare `inner Pneumatic.Gas gas` to choose another.",
    Documentation(info = "<html>
<p>Declared once in a circuit as <code>inner Pneumatic.Gas gas</code>. <code>p = rho R_s T</code>, <code>h = c_p T</code>, <code>u = c_v T</code>,
<code>c_p = kappa R_s/(kappa - 1)</code>, <code>c_v = c_p - R_s</code>.</p>
<p>The defaults are air in the standard reference atmosphere (ANR, ISO 8778): 100 kPa, 20 degC, 65 % relative humidity. Its humid air has a density of
1.185 kg/m3; <code>R_s = 288</code> gives 1.1845. Dry air has 287.05.</p>
<p>Valid for air from about 1 kPa to 2 MPa and from -40 to 150 degC, where the compressibility factor stays within 2 % of 1 and c_p within 2 %. Condensing water is left out.</p>
<p>Source: ISO 8778:2003; P. Beater, Pneumatic Drives, Springer 2007, chapter on the properties of air.</p></html>"));
end Gas;
