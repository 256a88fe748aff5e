within Mechanical.Rotational;
model Torque "Torque given by a signal, acting on a flange"
  Interfaces.RotationalFlange flange "Flange";
  Interfaces.RealInput tau(unit = "N.m") "Torque that accelerates the component joined";
equation
  flange.tau = -tau;
end Torque;
