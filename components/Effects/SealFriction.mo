within Effects;
model SealFriction "Friction of a seal in proportion to the pressure"
  extends Interfaces.TranslationalShuntAtChamber;
  parameter Real k(unit = "m2", min = 0, nominal = 2e-5) = 0 "Force per pascal";
  parameter SI.Velocity v_c(min = 1e-9) = 0.003 "Speed over which it changes sign";
equation
  f = k*Smooth.mag(p, 1e4)*tanh(v/v_c);
  annotation(__bramah(family = "pressure_friction", id = "E27", coefficients = {"k"}, shapes(v_c = {0.003})));
end SealFriction;
