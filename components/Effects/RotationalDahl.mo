within Effects;
model RotationalDahl "Friction with a hysteresis before it slides (Dahl)"
  extends Interfaces.RotationalShunt;
  parameter SI.Torque tau_c(min = 0, nominal = 0.1) = 0 "Friction when it slides";
  parameter SI.Angle b(min = 1e-12) = 0.01 "Way until it slides";
  parameter SI.AngularVelocity v_c(min = 1e-9) = 0.5 "Width of the corner";
  Real x(unit = "1", start = 0, fixed = true) "Share of the friction reached";
equation
  b*der(x) = w - Smooth.mag(w, v_c)*x;
  tau = tau_c*x;
  annotation(__bramah(family = "hysteresis", law = "dry friction", id = "E27", coefficients = {"tau_c"}, shapes(b = {0.003, 0.03, 0.3}, v_c = {0.5})));
end RotationalDahl;
