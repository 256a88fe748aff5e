within Mechanical.Rotational;
model Torque "Torque given by a signal, acting on a flange"
  Interfaces.RotationalFlange flange "Flange";
  Interfaces.RealInput tau(unit = "N.m") "Torque that accelerates the component joined";
equation
  flange.tau = -tau;
  annotation(Documentation(info = "<html><p>Positive values accelerate what is joined in the positive direction; the reaction goes to the housing.</p></html>"));
end Torque;
