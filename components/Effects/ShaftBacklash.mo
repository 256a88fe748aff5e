within Effects;
model ShaftBacklash "Play in a connection: the first side moves against the second within the gap"
  extends Interfaces.RotationalSeries;
  parameter SI.Angle b(min = 0, nominal = 0.01) = 0 "Width of the gap";
  parameter SI.Torque tau_min(nominal = 1) = 0 "Least torque that occurs";
  parameter SI.Torque tau_max(nominal = 1) = 1 "Greatest torque that occurs";
  parameter Real w(unit = "1", min = 1e-6) = 0.01 "Load that closes the gap over half the range of the torque";
  SI.Torque tau_s(nominal = 0.01) "Load that closes it";
equation
  tau_s = 0.5*w*(tau_max - tau_min);
  // no tanh: under load it would be flat to the last digit, and no torque would follow from the gap
  phi_rel = 0.5*b*tau/sqrt(tau^2 + tau_s^2);
  annotation(__bramah(family = "backlash", id = "E37", coefficients = {"b"}, shapes(w = {0.01}), range = {"tau", "tau_min", "tau_max"}));
end ShaftBacklash;
