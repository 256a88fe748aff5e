within Effects;
model EarlyOpeningBetween "A valve in parallel opens early and softly"
  extends Interfaces.HydraulicBridge;
  parameter Real K(unit = "m3/(s.Pa)", min = 0, nominal = 3e-11) = 0 "Conductance when open";
  parameter SI.Pressure p_o(min = 2e4, nominal = 1e6) = 5e6 "Pressure difference at which it begins to open";
  parameter SI.Pressure w(min = 1) = 2e5 "Width of the opening";
equation
  q = K*(Smooth.pos(dp - p_o, w) - Smooth.pos(-p_o, w));
  annotation(__bramah(family = "valve_early_opening", id = "E29", coefficients = {"K"}, shapes(p_o = {5e4, 1e6, 2.5e6, 5e6, 9e6}, w = {2e5}), threshold = {"p_o"}, ends = "free", directed = "yes"));
end EarlyOpeningBetween;
