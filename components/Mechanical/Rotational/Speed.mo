within Mechanical.Rotational;
model Speed "Moves a flange exactly with the speed of a signal"
  Interfaces.RotationalFlange flange "Flange";
  Interfaces.RealInput w_ref(unit = "rad/s") "Speed";
  SI.Angle phi(start = 0) "Angle";
  SI.AngularVelocity w(nominal = 10) "Speed";
equation
  flange.phi = phi;
  w = der(phi);
  w = w_ref;
  annotation(Documentation(info = "<html><p>The flange moves exactly as the signal says, whatever torque that takes; the signal may jump only where nothing with inertia is joined.</p></html>"));
end Speed;
