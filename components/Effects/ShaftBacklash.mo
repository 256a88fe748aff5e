within Effects;
model ShaftBacklash "Play in a connection: the first side moves against the second within the gap"
  extends Interfaces.RotationalSeries;
  parameter SI.Angle b(min = 0, nominal = 0.01) = 0 "Width of the gap";
  parameter SI.Torque tau_s(min = 1e-9) = 0.1 "Load that closes it";
equation
  phi_rel = 0.5*b*tanh(tau/tau_s);
  annotation(__bramah(family = "backlash", id = "E37", coefficients = {"b"}, shapes(tau_s = {0.1})));
end ShaftBacklash;
