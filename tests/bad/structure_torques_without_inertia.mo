//! E302: "nothing fixes the angle of {motor, load}"
model M
  Mechanical.Rotational.ConstantTorque motor(tau_constant = 1);
  Mechanical.Rotational.ConstantTorque load(tau_constant = -1);
equation
  connect(motor.flange, load.flange);
end M;
