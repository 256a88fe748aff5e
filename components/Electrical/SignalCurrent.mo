within Electrical;
model SignalCurrent "Current given by a signal, from p to n"
  Interfaces.Pin p "Positive pin";
  Interfaces.Pin n "Negative pin";
  Interfaces.RealInput i(unit = "A") "Current from p to n";
equation
  p.i = i;
  n.i = -i;
end SignalCurrent;
