//! E303: "is determined by both `motor` and `brake`"
model M
  Mechanical.Rotational.ConstantSpeed motor(w_fixed = 100);
  Mechanical.Rotational.ConstantSpeed brake(w_fixed = 0);
equation
  connect(motor.flange, brake.flange);
end M;
