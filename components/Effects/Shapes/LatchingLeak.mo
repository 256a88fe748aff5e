within Effects.Shapes;
model LatchingLeak "Leakage between two ports that opens above some pressure difference and closes again far below it"
  extends Interfaces.HydraulicBridge;
  parameter Real G(unit = "m3/(s.Pa)", min = 0, nominal = 3e-12) = 0 "Conductance when it is open";
  parameter SI.Pressure p_o(nominal = 1e6) = 1e6 "Pressure difference at which it opens";
  parameter Real h(unit = "1", min = 0) = 0.5 "Part of that difference by which it must fall until it closes";
  parameter SI.Time T(min = 1e-6) = 0.003 "Time in which it moves";
  Real z(unit = "1", start = 0, fixed = true) "Opening";
equation
  T*der(z) = 0.5*(1 + tanh(20*(dp/p_o - 1 + h*z))) - z;
  q = G*z*dp;
  annotation(__bramah(family = "shape", coefficients = {"G"}, shapes(p_o = {5e5, 1e6, 2e6, 4e6, 8e6}, T = {0.003, 0.03}), threshold = {"p_o"}, ends = "free", directed = "yes"));
end LatchingLeak;
