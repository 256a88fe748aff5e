within Pneumatic.Examples;
model ReservoirExample "A vessel is filled from one supply and emptied into another"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5, T = 313.15);
  Reservoir net(p = 3e5);
  Orifice inlet(C = 1e-8);
  Orifice outlet(C = 0.7e-8);
  Receiver vessel(V = 1e-3);
equation
  connect(supply.port, inlet.port_a);
  connect(inlet.port_b, vessel.port_a);
  connect(vessel.port_b, outlet.port_a);
  connect(outlet.port_b, net.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end ReservoirExample;
