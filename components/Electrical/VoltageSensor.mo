within Electrical;
model VoltageSensor "Voltage between two pins"
  Interfaces.Pin p "Positive pin";
  Interfaces.Pin n "Negative pin";
  Interfaces.RealOutput v(unit = "V") "Voltage";
equation
  p.i = 0;
  n.i = 0;
  v = p.v - n.v;
  annotation(Documentation(info = "<html><p>Without current.</p></html>"));
end VoltageSensor;
