within Electrical;
model SignalCurrent "Current given by a signal, from p to n"
  Interfaces.Pin p "Positive pin";
  Interfaces.Pin n "Negative pin";
  Interfaces.RealInput i(unit = "A") "Current from p to n";
equation
  p.i = i;
  n.i = -i;
  annotation(Documentation(info = "<html><p>Gives any voltage that the current of the signal needs.</p></html>"));
end SignalCurrent;
