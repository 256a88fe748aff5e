within Mechanical.Translational;
model Position "Moves a flange exactly along a signal"
  Interfaces.TranslationalFlange flange "Flange";
  Interfaces.RealInput s_ref(unit = "m") "Position";
equation
  flange.s = s_ref;
  annotation(Documentation(info = "<html><p>The position is given, and with it velocity and acceleration: the signal must be smooth enough for what is joined.</p></html>"));
end Position;
