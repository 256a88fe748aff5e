within Effects;
model RotationalViscousFriction "Friction in proportion to the speed"
  extends Interfaces.RotationalShunt;
  parameter SI.RotationalDampingConstant d(min = 0, nominal = 0.005) = 0 "Damping";
equation
  tau = d*w;
  annotation(__bramah(family = "viscous_friction", id = "E35", coefficients = {"d"}));
end RotationalViscousFriction;
