within Effects;
model LeakViscosityTemperature "Laminar leakage follows the viscosity, which falls with the temperature"
  extends Interfaces.HydraulicBridge;
  parameter Real k(unit = "1/K", min = 0, nominal = 0.02) = 0 "Relative fall of the viscosity per kelvin";
  parameter SI.Temperature T_r = 313.15 "Temperature at which the model is right";
  parameter Real G(unit = "m3/(s.Pa)") = 0 "Coefficient of the model";
  input SI.Temperature T "Temperature of the oil";
equation
  q = G*(exp(k*(T - T_r)) - 1)*dp;
  annotation(__bramah(family = "viscosity_temperature", id = "E17", group = "viscosity_temperature", coefficients = {"k"}, base = {"G"}, temperature = "T"));
end LeakViscosityTemperature;
