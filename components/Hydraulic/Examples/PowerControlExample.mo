within Hydraulic.Examples;
model PowerControlExample "A power-controlled pump while a valve closes and opens: full flow, hyperbola, cut-off"
  inner Oil.ISOVG46 oil "Oil";
  Mechanical.Rotational.ConstantSpeed motor(w_fixed = 157);
  Pump pump(V = 45e-6, useInput = true);
  PumpControl.PowerControl control(p_set = 250e5, V = pump.V, P_max = 11e3, w_nom = 157);
  Volume volume(V = 5e-4, p_start = 20e5);
  VariableOrifice load(A_max = 2e-5);
  Signal.Trapezoid closing(amplitude = -0.99, offset = 1, rising = 1.5, holding = 0.2, falling = 1.5, startTime = 0.2);
  Tank tank;
equation
  connect(motor.flange, pump.flange);
  connect(pump.port_b, tank.port);
  connect(pump.port_a, volume.port);
  connect(control.port_p, volume.port);
  connect(control.u, pump.u);
  connect(volume.port, load.port_a);
  connect(load.port_b, tank.port);
  connect(closing.y, load.u);
  annotation(experiment(StartTime = 0, StopTime = 3.6, Interval = 0.006, Tolerance = 1e-6));
end PowerControlExample;
