within Effects.Shapes;
model ResonantBranch "A branch of the line that nobody sees: a resonance of the oil"
  extends Interfaces.HydraulicShunt;
  parameter Real C(unit = "m3/Pa", min = 0, nominal = 3e-14) = 0 "Capacity of its end";
  parameter SI.Time T(min = 1e-6) = 0.01 "Period of its resonance over 2 pi";
  parameter Real zeta(unit = "1", min = 0) = 0.1 "Damping ratio";
  SI.Pressure y(nominal = 1e6) "Pressure at its end, that of the node at the start";
  Real z(unit = "Pa/s", nominal = 1e8, start = 0, fixed = true) "Rate of that pressure";
initial equation
  y = p;
equation
  der(y) = z;
  T^2*der(z) = p - y - 2*zeta*T*z;
  q = C*z;
  annotation(__bramah(family = "shape", coefficients = {"C"}, shapes(T = {0.003, 0.005, 0.008, 0.012, 0.02, 0.03, 0.05, 0.08})));
end ResonantBranch;
