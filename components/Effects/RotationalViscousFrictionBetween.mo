within Effects;
model RotationalViscousFrictionBetween "Friction in proportion to the speed"
  extends Interfaces.RotationalBridge;
  parameter SI.RotationalDampingConstant d(min = 0, nominal = 0.005) = 0 "Damping";
equation
  tau = d*w_rel;
  annotation(__bramah(family = "viscous_friction", id = "E35", coefficients = {"d"}, ends = "free"));
end RotationalViscousFrictionBetween;
