within Effects;
model TranslationalViscosityTemperature "Viscous friction follows the viscosity, which falls with the temperature"
  extends Interfaces.TranslationalBridge;
  parameter Real k(unit = "1/K", min = 0, nominal = 0.02) = 0 "Relative fall of the viscosity per kelvin";
  parameter SI.Temperature T_r = 313.15 "Temperature at which the model is right";
  parameter Real d(unit = "N.s/m") = 0 "Coefficient of the model";
  input SI.Temperature T "Temperature of the oil";
equation
  f = d*(exp(-k*(T - T_r)) - 1)*v_rel;
  annotation(__bramah(family = "viscosity_temperature", id = "E17", group = "viscosity_temperature", coefficients = {"k"}, base = {"d"}, temperature = "T"));
end TranslationalViscosityTemperature;
