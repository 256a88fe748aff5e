within Effects;
model TranslationalQuadraticDrag "Drag in proportion to the square of the speed"
  extends Interfaces.TranslationalShunt;
  parameter Real c(unit = "N.s2/m2", min = 0, nominal = 1000) = 0 "Drag over the square of the speed";
  parameter SI.Velocity v_c(min = 1e-9) = 0.003 "Width of the corner";
equation
  f = c*Smooth.mag(v, v_c)*v;
  annotation(__bramah(family = "quadratic_drag", id = "E35", coefficients = {"c"}));
end TranslationalQuadraticDrag;
