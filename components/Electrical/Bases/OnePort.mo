within Electrical.Bases;
partial model OnePort "Two pins with the same current"
  Interfaces.Pin p "Positive pin";
  Interfaces.Pin n "Negative pin";
  SI.Voltage v "Voltage from p to n";
  SI.Current i "Current from p to n";
equation
  v = p.v - n.v;
  p.i = i;
  n.i = -i;
end OnePort;
