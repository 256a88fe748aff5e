within Effects;
model EarlyOpening "A valve towards the low side opens early and softly"
  extends Interfaces.HydraulicDrain;
  parameter Real K(unit = "m3/(s.Pa)", min = 0, nominal = 3e-11) = 0 "Conductance when open";
  parameter SI.Pressure p_o(min = 2e4, nominal = 1e6) = 5e6 "Pressure difference at which it begins to open";
  parameter SI.Pressure w(min = 1) = 2e5 "Width of the opening";
equation
  q = K*(Smooth.pos(p - p_0 - p_o, w) - Smooth.pos(-p_o, w));
  annotation(__bramah(family = "valve_early_opening", id = "E34", coefficients = {"K"}, shapes(p_o = {1.5e6, 2.5e6, 4e6, 6e6, 9e6, 13e6, 18e6}, w = {2e5}), threshold = {"p_o"}));
end EarlyOpening;
