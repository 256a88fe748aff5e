within Oil.Heat;
function throttling "Temperature that oil gains when it expands from a pressure to the reference pressure without giving power or heat"
  input SI.Pressure p "Absolute pressure";
  replaceable function law = Oil.Compression.constantDensity constrainedby Oil.Compression.Law "Law of compression";
  input SI.SpecificHeatCapacity c_p = 1900 "Heat capacity";
  input SI.CubicExpansionCoefficient gamma = 7e-4 "Expansion per kelvin, over the volume at T_0";
  input SI.Temperature T_0 = 313.15 "Temperature of the law of compression";
  output SI.TemperatureDifference dT(nominal = 1) "Gain of temperature";
protected
  SI.Density rho "Density at T_0";
  SI.BulkModulus beta "Tangent bulk modulus";
  SI.SpecificEnthalpy w "Integral of dp/rho at T_0";
algorithm
  (rho, beta, w) := law(p);
  dT := (1 - gamma*T_0)*w/c_p;
  annotation(Inline = true, Documentation(info = "<html><p><code>(1 - gamma T_0) w(p)/c_p</code>: the enthalpy that the pressure makes, as a temperature; the effect of Joule and Thomson, about 0.48 K per MPa for mineral oil. Valid as far as expansion and heat capacity are constant, some 50 K about T_0. Source: H. D. Baehr and S. Kabelac, Thermodynamik, Springer 2016.</p></html>"));
end throttling;
