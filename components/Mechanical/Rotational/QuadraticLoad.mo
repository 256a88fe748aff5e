within Mechanical.Rotational;
model QuadraticLoad "Load that grows with the square of speed, against the motion"
  Interfaces.RotationalFlange flange "Flange";
  parameter SI.Torque tau_nominal(min = 0) = 1 "Magnitude at w_nominal";
  parameter SI.AngularVelocity w_nominal(min = 1e-9) = 100 "Speed of tau_nominal";
  SI.AngularVelocity w(nominal = 10) "Speed";
equation
  assert(w_nominal > 0, "w_nominal must be positive");
  w = der(flange.phi);
  flange.tau = tau_nominal*(w/w_nominal)*noEvent(abs(w/w_nominal));
  annotation(Documentation(info = "<html><p>A fan or a ship: the torque grows with the square of the speed and acts against it.</p></html>"));
end QuadraticLoad;
