within Effects;
model CommandDeadTime "The command acts later: all-pass of second order in place of the dead time"
  extends Interfaces.Command;
  parameter Real k(unit = "1", min = 0, max = 1, nominal = 1) = 0 "Share that comes late, 1 for a pure dead time";
  parameter SI.Time T_d(min = 1e-6) = 3e-3 "Dead time";
  Real x "Filtered command";
  Real z "Fall of the command during the dead time";
initial equation
  x = u;
  z = 0;
equation
  T_d*der(x) = z;
  T_d*der(z) = 12*(u - x) - 6*z;
  y = u - k*z;
  annotation(__bramah(family = "dead_time", id = "E39", coefficients = {"k"}, shapes(T_d = {1e-3, 2e-3, 4e-3, 8e-3, 20e-3})));
end CommandDeadTime;
