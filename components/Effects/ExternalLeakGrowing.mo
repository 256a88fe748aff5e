within Effects;
model ExternalLeakGrowing "Leakage to the low side that grows faster than the pressure, as gaps widen"
  extends Interfaces.HydraulicDrain;
  parameter Real G_p(unit = "m3/(s.Pa2)", min = 0, nominal = 3e-19) = 0 "Growth of the conductance with the pressure";
  parameter SI.Pressure p_s(min = 1) = 1e5 "Width of the corner";
equation
  q = G_p*Smooth.mag(p - p_0, p_s)*(p - p_0);
  annotation(__bramah(family = "external_leak", id = "E31", coefficients = {"G_p"}, shapes(p_s = {1e5})));
end ExternalLeakGrowing;
