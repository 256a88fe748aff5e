within Electrical.Examples;
model DiodeBridgeExample "Six diodes on lines with inductance feed a coil and a resistor; beside them the mean"
  ThreePhaseVoltage mains(U = 400/sqrt(3));
  Inductor line[3](each L = 0.5e-3);
  Resistor lineR[3](each R = 0.01);
  DiodeBridge bridge;
  Inductor choke(L = 20e-3);
  Resistor load(R = 20);
  Ground ground;
  Rectifier mean(L = 0.5e-3, R = 0.01);
  Inductor choke2(L = 20e-3);
  Resistor load2(R = 20);
equation
  connect(mains.a, line[1].p);
  connect(mains.b, line[2].p);
  connect(mains.c, line[3].p);
  for j in 1:3 loop
    connect(line[j].n, lineR[j].p);
  end for;
  connect(lineR[1].n, bridge.a);
  connect(lineR[2].n, bridge.b);
  connect(lineR[3].n, bridge.c);
  connect(bridge.n, ground.p);
  connect(bridge.p, choke.p);
  connect(choke.n, load.p);
  connect(load.n, bridge.n);
  connect(mean.p, choke2.p);
  connect(choke2.n, load2.p);
  connect(load2.n, mean.n);
  connect(mean.n, ground.p);
  annotation(experiment(StartTime = 0, StopTime = 0.1, Interval = 0.00005, Tolerance = 1e-6));
end DiodeBridgeExample;
