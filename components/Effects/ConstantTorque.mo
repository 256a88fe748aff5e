within Effects;
model ConstantTorque "A constant load"
  extends Interfaces.RotationalShunt;
  parameter SI.Torque tau_0(nominal = 0.1) = 0 "Load, against positive motion";
equation
  tau = tau_0;
  annotation(__bramah(family = "constant_force", id = "E27", coefficients = {"tau_0"}));
end ConstantTorque;
