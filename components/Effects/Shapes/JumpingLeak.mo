within Effects.Shapes;
model JumpingLeak "Leakage between two ports that opens at once above some pressure difference"
  extends Interfaces.HydraulicBridge;
  parameter Real G(unit = "m3/(s.Pa)", min = 0, nominal = 3e-12) = 0 "Conductance above the pressure at which it opens";
  parameter SI.Pressure p_o(nominal = 1e6) = 1e6 "Pressure difference at which it opens";
equation
  q = 0.5*G*dp*(1 + tanh(40*(dp - p_o)/p_o));
  annotation(__bramah(family = "shape", coefficients = {"G"}, shapes(p_o = {5e5, 1e6, 2e6, 4e6, 8e6}), threshold = {"p_o"}, ends = "free", directed = "yes"));
end JumpingLeak;
