within Effects.Shapes;
model PeriodicForce "A periodic force that follows no variable"
  extends Interfaces.TranslationalShunt;
  parameter SI.Force a_s(nominal = 10) = 0 "Amplitude of the sine";
  parameter SI.Force a_c(nominal = 10) = 0 "Amplitude of the cosine";
  parameter SI.Frequency nu(min = 1e-9) = 10 "Its frequency";
equation
  f = a_s*sin(6.283185307179586*nu*time) + a_c*cos(6.283185307179586*nu*time);
  annotation(__bramah(family = "shape", coefficients = {"a_s", "a_c"}, own = {"a_s", "a_c"}, shapes(nu = {10}), line = {"nu"}));
end PeriodicForce;
