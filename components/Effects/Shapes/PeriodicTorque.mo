within Effects.Shapes;
model PeriodicTorque "A periodic torque that follows no variable"
  extends Interfaces.RotationalShunt;
  parameter SI.Torque a_s(nominal = 0.1) = 0 "Amplitude of the sine";
  parameter SI.Torque a_c(nominal = 0.1) = 0 "Amplitude of the cosine";
  parameter SI.Frequency nu(min = 1e-9) = 10 "Its frequency";
equation
  tau = a_s*sin(6.283185307179586*nu*time) + a_c*cos(6.283185307179586*nu*time);
  annotation(__bramah(family = "shape", coefficients = {"a_s", "a_c"}, own = {"a_s", "a_c"}, shapes(nu = {10}), line = {"nu"}));
end PeriodicTorque;
