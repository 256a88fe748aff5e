within Effects;
model FlowRipple "Delivery periodic in the angle of the shaft"
  extends Interfaces.HydraulicBridgeAtShaft;
  parameter Real V_s(unit = "m3/rad", nominal = 3e-8) = 0 "Amplitude of the sine";
  parameter Real V_k(unit = "m3/rad", nominal = 3e-8) = 0 "Amplitude of the cosine";
  parameter Real n(unit = "1") = 1 "Periods a turn";
equation
  q = (V_s*sin(n*phi) + V_k*cos(n*phi))*w;
  annotation(__bramah(family = "flow_ripple", id = "E06", coefficients = {"V_s", "V_k"}, shapes(n = {1, 5, 7, 9, 10, 11, 14, 18}), order = {"n"}));
end FlowRipple;
