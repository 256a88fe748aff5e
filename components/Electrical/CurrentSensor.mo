within Electrical;
model CurrentSensor "Current through a line"
  Interfaces.Pin p "Positive pin";
  Interfaces.Pin n "Negative pin";
  Interfaces.RealOutput i(unit = "A") "Current from p to n";
equation
  p.v = n.v;
  p.i = i;
  n.i = -i;
  annotation(Documentation(info = "<html><p>Without voltage drop.</p></html>"));
end CurrentSensor;
