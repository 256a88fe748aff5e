within Signal;
block LimPI "PI controller with limited output and back calculation against windup"
  parameter Real k = 1 "Gain";
  parameter SI.Time T_i(min = 1e-9) = 1 "Time of the integrator";
  parameter SI.Time T_t(min = 1e-9) = T_i "Time in which the integrator follows the limit";
  parameter Real yMax = 1 "Upper limit";
  parameter Real yMin = -yMax "Lower limit";
  parameter Real x_start = 0 "Integral part at the start";
  Interfaces.RealInput u_s "Set point";
  Interfaces.RealInput u_m "Measured value";
  Interfaces.RealOutput y "Output";
  Real x(start = x_start, fixed = true) "Integral part";
protected
  Real v "Output before the limits";
equation
  assert(T_i > 0 and T_t > 0, "The times T_i and T_t must be positive");
  assert(yMax > yMin, "yMax must lie above yMin");
  v = k*(u_s - u_m) + x;
  y = smooth(0, if v > yMax then yMax elseif v < yMin then yMin else v);
  der(x) = k/T_i*(u_s - u_m) + (y - v)/T_t;
  annotation(Documentation(info = "<html><p>Source: K. J. Astrom and T. Hagglund, PID Controllers, 1995, section 3.5.</p></html>"));
end LimPI;
