within Effects;
model TorqueRipple "Torque periodic in the angle of the shaft"
  extends Interfaces.RotationalShunt;
  parameter SI.Torque tau_s(nominal = 0.2) = 0 "Amplitude of the sine";
  parameter SI.Torque tau_k(nominal = 0.2) = 0 "Amplitude of the cosine, 0 at the start";
  parameter Real n(unit = "1") = 1 "Periods a turn";
equation
  tau = tau_s*sin(n*phi) + tau_k*cos(n*phi);
  annotation(__bramah(family = "torque_ripple", id = "E04", coefficients = {"tau_s", "tau_k"}, shapes(n = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 14, 18, 24}), order = {"n"}));
end TorqueRipple;
