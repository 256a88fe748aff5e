within Effects;
model SeriesResistance "Further resistance of a winding or a contact"
  extends Interfaces.ElectricalSeries;
  parameter SI.Resistance R(min = 0, nominal = 0.1) = 0 "Resistance";
equation
  v = R*i;
  annotation(__bramah(family = "flux_or_resistance_drift", id = "E15", coefficients = {"R"}));
end SeriesResistance;
