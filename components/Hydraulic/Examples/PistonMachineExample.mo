within Hydraulic.Examples;
model PistonMachineExample "Ripple of a pump with seven pistons"
  inner Oil.ISOVG46 oil "Oil";
  Mechanical.Rotational.ConstantSpeed drive(w_fixed = 100);
  PistonMachine pump;
  Tank tank(p = 5e5);
  Volume volume(V = 2e-5, p_start = 50e5);
  Orifice load(A = 0.18e-6);
equation
  connect(drive.flange, pump.flange);
  connect(pump.port_b, tank.port);
  connect(pump.port_case, tank.port);
  connect(pump.port_a, volume.port);
  connect(volume.port, load.port_a);
  connect(load.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 0.2, Interval = 0.0001, Tolerance = 1e-6));
end PistonMachineExample;
