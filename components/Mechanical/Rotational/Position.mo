within Mechanical.Rotational;
model Position "Moves a flange exactly along a signal"
  Interfaces.RotationalFlange flange "Flange";
  Interfaces.RealInput phi_ref(unit = "rad") "Angle";
equation
  flange.phi = phi_ref;
  annotation(Documentation(info = "<html><p>The angle is given, and with it speed and acceleration: the signal must be smooth enough for what is joined.</p></html>"));
end Position;
