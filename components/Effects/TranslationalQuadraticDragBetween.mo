within Effects;
model TranslationalQuadraticDragBetween "Drag in proportion to the square of the speed"
  extends Interfaces.TranslationalBridge;
  parameter Real c(unit = "N.s2/m2", min = 0, nominal = 1000) = 0 "Drag over the square of the speed";
  parameter SI.Velocity v_c(min = 1e-9) = 0.003 "Width of the corner";
equation
  f = c*Smooth.mag(v_rel, v_c)*v_rel;
  annotation(__bramah(family = "quadratic_drag", id = "E35", coefficients = {"c"}, ends = "free"));
end TranslationalQuadraticDragBetween;
