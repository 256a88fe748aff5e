within Effects;
model InternalLeakTurbulent "Leakage through an orifice"
  extends Interfaces.HydraulicBridge;
  parameter Real K(unit = "m3/(s.Pa0.5)", min = 0, nominal = 3e-9) = 0 "Flow over the root of the pressure";
  parameter SI.Pressure p_s(min = 1) = 1e5 "Pressure below which it is laminar";
equation
  q = K*Smooth.root(dp, p_s);
  annotation(__bramah(family = "internal_leak", id = "E20", coefficients = {"K"}, shapes(p_s = {1e5}), ends = "free"));
end InternalLeakTurbulent;
