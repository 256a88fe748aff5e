within Effects;
model OverflowInto "Above some pressure, as that of a level, oil runs past a component into the next node"
  extends Interfaces.HydraulicBridge;
  parameter Real K(unit = "m3/(s.Pa)", min = 0, nominal = 1e-8) = 0 "Conductance above the brim";
  parameter SI.Pressure p_o(max = 2e5, nominal = 1e4) = 1.1e5 "Pressure at the brim, absolute";
  parameter SI.Pressure w(min = 1e-3) = 100 "Width of the corner";
equation
  q = K*Smooth.pos(p_a - p_o, w);
  annotation(__bramah(family = "overflow", id = "E40", coefficients = {"K"}, shapes(p_o = {5e2, 2e3, 1e4, 1.02e5, 1.05e5, 1.1e5, 1.2e5}, w = {100}), level = {"p_o"}, ends = "free", directed = "yes"));
end OverflowInto;
