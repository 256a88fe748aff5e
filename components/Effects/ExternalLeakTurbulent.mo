within Effects;
model ExternalLeakTurbulent "Leakage to the low side through a sharp edge"
  extends Interfaces.HydraulicDrain;
  parameter Real K(unit = "m3/(s.Pa0.5)", min = 0, nominal = 3e-9) = 0 "Flow over the root of the pressure";
  parameter SI.Pressure p_s(min = 1) = 1e5 "Pressure below which it is laminar";
equation
  q = K*Smooth.root(p - p_0, p_s);
  annotation(__bramah(family = "external_leak", id = "E20", coefficients = {"K"}, shapes(p_s = {1e5})));
end ExternalLeakTurbulent;
