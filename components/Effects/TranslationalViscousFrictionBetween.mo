within Effects;
model TranslationalViscousFrictionBetween "Friction in proportion to the speed"
  extends Interfaces.TranslationalBridge;
  parameter SI.TranslationalDampingConstant d(min = 0, nominal = 300) = 0 "Damping";
equation
  f = d*v_rel;
  annotation(__bramah(family = "viscous_friction", id = "E35", coefficients = {"d"}, ends = "free"));
end TranslationalViscousFrictionBetween;
