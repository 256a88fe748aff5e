within Electrical;
model SignalVoltage "Voltage given by a signal"
  Interfaces.Pin p "Positive pin";
  Interfaces.Pin n "Negative pin";
  Interfaces.RealInput v(unit = "V") "Voltage from p to n";
  SI.Current i "Current from p to n";
equation
  p.v - n.v = v;
  p.i = i;
  n.i = -i;
  annotation(Documentation(info = "<html><p>Gives any current at the voltage of the signal.</p></html>"));
end SignalVoltage;
