within Effects;
model CommandDeadTime "The command acts later: approximant of fifth order in place of the dead time"
  extends Interfaces.Command;
  parameter Real k(unit = "1", min = 0, max = 1, nominal = 1) = 0 "Share that comes late, 1 for a pure dead time";
  parameter SI.Time T_d(min = 1e-6) = 3e-3 "Dead time";
  Real x "Filtered command";
  Real z "Change of it during the dead time";
  Real b "Change of that during the dead time";
initial equation
  x = u;
  z = 0;
  b = 0;
equation
  T_d*der(x) = z;
  T_d*der(z) = b;
  T_d*der(b) = 60*(u - x) - 36*z - 9*b;
  y = u + k*(x - 2/5*z + b/20 - u);
  annotation(__bramah(family = "dead_time", id = "E39", coefficients = {"k"}, shapes(T_d = {1e-3, 2e-3, 4e-3, 8e-3, 20e-3}), measured = "yes"));
end CommandDeadTime;
