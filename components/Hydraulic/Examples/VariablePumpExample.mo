within Hydraulic.Examples;
model VariablePumpExample "A pump whose displacement goes over centre"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Ramp speed(height = 150, duration = 0.2);
  Mechanical.Rotational.Speed drive;
  Pump pump(V = 10e-6, G = 5e-13, useInput = true);
  Signal.Sine stroke(f = 2);
  Tank tank(p = 5e5);
  Volume volume(V = 2e-4, p_start = 5e5);
  Orifice load(A = 1.2e-6);
equation
  connect(speed.y, drive.w_ref);
  connect(drive.flange, pump.flange);
  connect(pump.port_b, tank.port);
  connect(pump.port_a, volume.port);
  connect(volume.port, load.port_a);
  connect(load.port_b, tank.port);
  connect(stroke.y, pump.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end VariablePumpExample;
