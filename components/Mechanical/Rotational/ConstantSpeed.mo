within Mechanical.Rotational;
model ConstantSpeed "Moves a flange with constant speed"
  Interfaces.RotationalFlange flange "Flange";
  parameter SI.AngularVelocity w_fixed = 100 "Speed";
  parameter SI.Angle phi_start = 0 "Angle at time 0";
equation
  flange.phi = phi_start + w_fixed*time;
  annotation(Documentation(info = "<html><p>The angle grows evenly, whatever torque that takes.</p></html>"));
end ConstantSpeed;
