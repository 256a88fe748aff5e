within Mechanical.Translational;
model Position "Moves a flange exactly along a signal"
  Interfaces.TranslationalFlange flange "Flange";
  Interfaces.RealInput s_ref(unit = "m") "Position";
equation
  flange.s = s_ref;
end Position;
