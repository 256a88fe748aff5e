within Effects;
model TranslationalViscousFriction "Friction in proportion to the speed"
  extends Interfaces.TranslationalShunt;
  parameter SI.TranslationalDampingConstant d(min = 0, nominal = 300) = 0 "Damping";
equation
  f = d*v;
  annotation(__bramah(family = "viscous_friction", id = "E35", coefficients = {"d"}));
end TranslationalViscousFriction;
