model {{Name}} "A pump fills a line, a relief valve limits its pressure, an orifice is the load"
  // A circuit is a list of components and a list of connections. Everything after // is a remark.
  // Values in this text are in SI units: Pa, m3, m3/s, rad/s. On the command line and in {{name}}.toml you may
  // write units: --set pump.V="12 ml".

  // The oil of all components below. Its laws of viscosity and stiffness can be replaced; see components/Oil.
  inner Oil.Fluid oil "Oil";

  // The motor: its speed rises within half a second and is held then.
  Signal.Ramp speed(height = 157, duration = 0.5) "1500 rev/min, in rad/s";
  Mechanical.Rotational.Speed motor "Holds the shaft at the speed of the signal";

  Hydraulic.Pump pump(V = 10e-6) "10 ml per revolution; port_a is the high side";
  Hydraulic.Tank suction "Where the pump takes its oil from";
  Hydraulic.Volume line(V = 0.5e-3) "Half a litre of oil between pump, valve and load";
  Hydraulic.ReliefValve relief(p_set = 150e5, q_nom = 0.5e-3) "Opens at 150 bar";
  Hydraulic.Orifice load(A = 2e-6) "The load: 2 mm2";
  Hydraulic.Tank return_tank "Where valve and load give their oil to";
equation
  connect(speed.y, motor.w_ref);
  connect(motor.flange, pump.flange);
  connect(suction.port, pump.port_b);
  connect(pump.port_a, line.port);
  connect(line.port, relief.port_a);
  connect(line.port, load.port_a);
  connect(relief.port_b, return_tank.port);
  connect(load.port_b, return_tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end {{Name}};
