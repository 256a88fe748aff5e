within Mechanical.Translational;
model Speed "Moves a flange exactly with the speed of a signal"
  Interfaces.TranslationalFlange flange "Flange";
  Interfaces.RealInput v_ref(unit = "m/s") "Speed";
  SI.Position s(nominal = 1e-2, start = 0) "Position";
  SI.Velocity v(nominal = 0.1) "Speed";
equation
  flange.s = s;
  v = der(s);
  v = v_ref;
  annotation(Documentation(info = "<html><p>The flange moves exactly as the signal says, whatever force that takes; the signal may jump only where nothing with inertia is joined.</p></html>"));
end Speed;
