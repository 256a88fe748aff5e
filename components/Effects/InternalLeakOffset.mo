within Effects;
model InternalLeakOffset "Leakage that is there at small pressures already"
  extends Interfaces.HydraulicBridge;
  parameter SI.VolumeFlowRate Q_0(min = 0, nominal = 2e-6) = 0 "Leakage at high pressure";
  parameter SI.Pressure p_s(min = 1) = 3e5 "Pressure at which it is reached";
equation
  q = Q_0*tanh(dp/p_s);
  annotation(__bramah(family = "internal_leak", id = "E20", coefficients = {"Q_0"}, shapes(p_s = {3e5}), ends = "free"));
end InternalLeakOffset;
