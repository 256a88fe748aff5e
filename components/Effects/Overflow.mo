within Effects;
model Overflow "Above some pressure, as that of a level, oil leaves to the low side"
  extends Interfaces.HydraulicDrain;
  parameter Real K(unit = "m3/(s.Pa)", min = 0, nominal = 1e-8) = 0 "Conductance above the brim";
  parameter SI.Pressure p_o(max = 1e5, nominal = 1e4) = 5e3 "Pressure at the brim, over the low side";
  parameter SI.Pressure w(min = 1e-3) = 100 "Width of the corner";
equation
  q = K*(Smooth.pos(p - p_0 - p_o, w) - Smooth.pos(-p_o, w));
  annotation(__bramah(family = "overflow", id = "E40", coefficients = {"K"}, shapes(p_o = {5e2, 1e3, 2e3, 5e3, 1e4, 2e4}, w = {100}), threshold = {"p_o"}));
end Overflow;
