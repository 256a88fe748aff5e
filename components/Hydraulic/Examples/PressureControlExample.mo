within Hydraulic.Examples;
model PressureControlExample "A pressure-controlled pump with a torque limit while a valve closes"
  inner Oil.ISOVG46 oil "Oil";
  Mechanical.Rotational.ConstantSpeed motor(w_fixed = 157);
  Pump pump(V = 45e-6, useInput = true);
  PumpControl.PressureControl control(p_set = 200e5, V = pump.V, T_max = 90);
  Volume volume(V = 5e-4, p_start = 20e5);
  VariableOrifice load(A_max = 2e-5);
  Signal.Ramp closing(height = -0.99, offset = 1, duration = 1.5, startTime = 0.2);
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
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end PressureControlExample;
