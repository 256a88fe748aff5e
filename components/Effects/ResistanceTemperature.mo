within Effects;
model ResistanceTemperature "Resistance that grows with the temperature"
  extends Interfaces.ElectricalSeries;
  parameter Real R_T(unit = "Ohm/K", min = 0, nominal = 0.003) = 0 "Growth of the resistance per kelvin";
  parameter SI.Temperature T_r = 293.15 "Temperature at which the model is right";
  input SI.Temperature T "Temperature";
equation
  v = R_T*(T - T_r)*i;
  annotation(__bramah(family = "flux_or_resistance_drift", id = "E15", coefficients = {"R_T"}, temperature = "T"));
end ResistanceTemperature;
