within Electrical;
model PowerSensor "Power between two parts of a circuit"
  Interfaces.Pin pc "Current path, in";
  Interfaces.Pin nc "Current path, out";
  Interfaces.Pin pv "Voltage path, positive";
  Interfaces.Pin nv "Voltage path, negative";
  Interfaces.RealOutput power(unit = "W") "Power from pc to nc at the voltage between pv and nv";
equation
  pc.v = nc.v;
  pc.i + nc.i = 0;
  pv.i = 0;
  nv.i = 0;
  power = (pv.v - nv.v)*pc.i;
  annotation(Documentation(info = "<html><p>Without influence on the circuit.</p></html>"));
end PowerSensor;
