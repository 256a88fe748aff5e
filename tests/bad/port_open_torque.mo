//! E103 at 3: "port `motor.flange` is not connected"
model M
  Mechanical.Rotational.ConstantTorque motor(tau_constant = 1);
end M;
