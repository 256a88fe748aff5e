within Hydraulic.Examples;
model BaffledReservoirExample "Oil that returns warmer reaches the suction line after the time of residence"
  inner Oil.ISOVG46 oil(thermal = true) "Oil";
  FlowSource back(q = 5e-4, dT = 10);
  FlowSource pump(q = -5e-4);
  BaffledReservoir tank(n = 5, A = 0.1, h_start = 0.3);
equation
  connect(back.port, tank.port_a);
  connect(pump.port, tank.port_b);
  annotation(experiment(StartTime = 0, StopTime = 200, Interval = 0.4, Tolerance = 1e-6));
end BaffledReservoirExample;
