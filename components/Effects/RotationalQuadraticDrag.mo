within Effects;
model RotationalQuadraticDrag "Drag in proportion to the square of the speed"
  extends Interfaces.RotationalShunt;
  parameter Real c(unit = "N.m.s2/rad2", min = 0, nominal = 1e-5) = 0 "Drag over the square of the speed";
  parameter SI.AngularVelocity v_c(min = 1e-9) = 0.5 "Width of the corner";
equation
  tau = c*Smooth.mag(w, v_c)*w;
  annotation(__bramah(family = "quadratic_drag", id = "E35", coefficients = {"c"}));
end RotationalQuadraticDrag;
