within Mechanical.Rotational;
model Speed "Moves a flange exactly with the speed of a signal"
  Interfaces.RotationalFlange flange "Flange";
  Interfaces.RealInput w_ref(unit = "rad/s") "Speed";
  SI.Angle phi(start = 0, fixed = true) "Angle";
  SI.AngularVelocity w(nominal = 10) "Speed";
equation
  flange.phi = phi;
  w = der(phi);
  w = w_ref;
end Speed;
