within Effects;
model ShaftBacklash "Play in a connection: the first side moves against the second within the gap"
  extends Interfaces.RotationalSeries;
  parameter SI.Angle b(min = 0, nominal = 0.01) = 0 "Width of the gap";
  parameter SI.Torque tau_min(nominal = 1) = 0 "Least torque that occurs";
  parameter SI.Torque tau_max(nominal = 1) = 1 "Greatest torque that occurs";
  parameter Real w(unit = "1", min = 1e-6) = 0.01 "Load within the gap over half the range of the torque";
  SI.Torque tau_r(nominal = 1) "Half the range";
  Real rho(unit = "1", start = 0) "Part of half the gap that is used; beyond 1 the sides press on each other";
protected
  constant Real e = 0.05 "Part of half the gap by which half the range presses the sides together";
  final parameter Real d = 2*w*e "Width of the corners: there the load is twice that within the gap";
equation
  tau_r = 0.5*(tau_max - tau_min);
  phi_rel = 0.5*b*rho;
  // a law that ended at the edge of the gap would have no solution where a step goes beyond it; one of the load over rho is
  // found from either side by Newton's method, for it bends one way only
  tau = tau_r*(w*rho + (rho + 0.5*(sqrt((rho - 1)^2 + d^2) - sqrt((rho + 1)^2 + d^2)))/e);
  annotation(__bramah(family = "backlash", id = "E37", coefficients = {"b"}, shapes(w = {0.01}), range = {"tau", "tau_min", "tau_max"}));
end ShaftBacklash;
