within Effects;
model InternalLeakGrowing "The gap of a leakage grows with the pressure"
  extends Interfaces.HydraulicBridge;
  parameter Real G_p(unit = "m3/(s.Pa2)", min = 0, nominal = 3e-19) = 0 "Growth of the conductance with the pressure";
  parameter SI.Pressure p_s(min = 1) = 1e5 "Width of the corner";
equation
  q = G_p*Smooth.mag(dp, p_s)*dp;
  annotation(__bramah(family = "internal_leak", id = "E31", coefficients = {"G_p"}, shapes(p_s = {1e5}), ends = "free"));
end InternalLeakGrowing;
