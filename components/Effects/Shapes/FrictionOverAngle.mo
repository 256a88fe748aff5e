within Effects.Shapes;
model FrictionOverAngle "Dry friction that depends on the angle of the shaft"
  extends Interfaces.RotationalShunt;
  parameter SI.Torque tau_0(min = 0, nominal = 0.1) = 0 "Friction on the average";
  parameter SI.Torque tau_k1(nominal = 0.1) = 0 "Cosine of its change with the turn";
  parameter SI.Torque tau_s1(nominal = 0.1) = 0 "Sine of its change with the turn";
  parameter SI.Torque tau_k2(nominal = 0.1) = 0 "Cosine of its change with half a turn";
  parameter SI.Torque tau_s2(nominal = 0.1) = 0 "Sine of its change with half a turn";
  parameter SI.Torque tau_k3(nominal = 0.1) = 0 "Cosine of its change with a third of a turn";
  parameter SI.Torque tau_s3(nominal = 0.1) = 0 "Sine of its change with a third of a turn";
  parameter SI.AngularVelocity w_c(min = 1e-9) = 0.1 "Speed over which it changes sign";
equation
  tau = tanh(w/w_c)*(tau_0 + tau_k1*cos(phi) + tau_s1*sin(phi) + tau_k2*cos(2*phi) + tau_s2*sin(2*phi) + tau_k3*cos(3*phi) + tau_s3*sin(3*phi));
  annotation(__bramah(family = "shape", coefficients = {"tau_0", "tau_k1", "tau_s1", "tau_k2", "tau_s2", "tau_k3", "tau_s3"}, shapes(w_c = {0.1, 1})));
end FrictionOverAngle;
