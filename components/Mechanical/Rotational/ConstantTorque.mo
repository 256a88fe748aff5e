within Mechanical.Rotational;
model ConstantTorque "Constant torque acting on a flange"
  Interfaces.RotationalFlange flange "Flange";
  parameter SI.Torque tau_constant = 1 "Torque that accelerates the component joined";
equation
  flange.tau = -tau_constant;
  annotation(Documentation(info = "<html><p>Positive values accelerate what is joined in the positive direction.</p></html>"));
end ConstantTorque;
