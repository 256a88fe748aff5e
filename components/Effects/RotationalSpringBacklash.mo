within Effects;
model RotationalSpringBacklash "Play in an elastic connection: the torque of its spring is missing inside the gap"
  extends Interfaces.RotationalBridge;
  parameter SI.RotationalSpringConstant c(min = 0, nominal = 1e3) = 0 "Stiffness that is missing inside the gap";
  parameter SI.Angle b(min = 0) = 1e-2 "Width of the gap";
equation
  tau = -c*0.5*b*tanh(phi_rel/(0.5*b));
  annotation(__bramah(family = "backlash", id = "E37", coefficients = {"c"}, shapes(b = {2e-3, 1e-2, 5e-2})));
end RotationalSpringBacklash;
