within Effects;
model SpringBacklash "Play in an elastic connection: the force of its spring is missing inside the gap"
  extends Interfaces.TranslationalBridge;
  parameter SI.TranslationalSpringConstant c(min = 0, nominal = 1e5) = 0 "Stiffness that is missing inside the gap";
  parameter SI.Length b(min = 0) = 1e-3 "Width of the gap";
equation
  f = -c*0.5*b*tanh(s_rel/(0.5*b));
  annotation(__bramah(family = "backlash", id = "E37", coefficients = {"c"}, shapes(b = {2e-4, 6e-4, 1.5e-3, 4e-3})));
end SpringBacklash;
