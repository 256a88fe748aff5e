within Effects;
model LoadRipple "Torque periodic in the angle that grows with the pressure difference"
  extends Interfaces.RotationalShuntAtMachine;
  parameter Real a_s(unit = "m3/rad", nominal = 1e-7) = 0 "Amplitude of the sine per pascal";
  parameter Real a_k(unit = "m3/rad", nominal = 1e-7) = 0 "Amplitude of the cosine per pascal";
  parameter Real n(unit = "1") = 1 "Periods a turn";
equation
  tau = dp*(a_s*sin(n*phi) + a_k*cos(n*phi));
  annotation(__bramah(family = "torque_ripple", id = "E05", coefficients = {"a_s", "a_k"}, shapes(n = {1, 2, 9, 18}), order = {"n"}));
end LoadRipple;
