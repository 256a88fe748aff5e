within Effects;
model MachineFriction "Friction of a machine in proportion to the pressure difference"
  extends Interfaces.RotationalShuntAtMachine;
  parameter Real k(unit = "m3/rad", min = 0, nominal = 1e-7) = 0 "Torque lost per pascal";
  parameter SI.AngularVelocity w_c(min = 1e-9) = 0.5 "Speed over which it changes sign";
equation
  tau = k*Smooth.mag(dp, 1e4)*tanh(w/w_c);
  annotation(__bramah(family = "pressure_friction", id = "E03", coefficients = {"k"}, shapes(w_c = {0.5})));
end MachineFriction;
