within Hydraulic.Examples;
model SilencingGroovesExample "A pump with silencing grooves beside one that opens at once and one with one-way ports"
  inner Oil.ISOVG46 oil "Oil";
  Mechanical.Rotational.ConstantSpeed drive(w_fixed = 100);
  PistonMachine abrupt;
  PistonMachine grooved(A_groove = 0.3e-6, early = 0.14);
  PistonMachine oneWay(oneWay = true);
  PressureSource high(p = 100e5);
  Tank low(p = 5e5);
equation
  connect(drive.flange, abrupt.flange);
  connect(drive.flange, grooved.flange);
  connect(drive.flange, oneWay.flange);
  connect(abrupt.port_a, high.port);
  connect(grooved.port_a, high.port);
  connect(oneWay.port_a, high.port);
  connect(abrupt.port_b, low.port);
  connect(grooved.port_b, low.port);
  connect(oneWay.port_b, low.port);
  connect(abrupt.port_case, low.port);
  connect(grooved.port_case, low.port);
  connect(oneWay.port_case, low.port);
  annotation(experiment(StartTime = 0, StopTime = 0.0628, Interval = 0.0001, Tolerance = 1e-6));
end SilencingGroovesExample;
