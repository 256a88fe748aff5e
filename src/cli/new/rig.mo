model {{Name}} "Nominal model of a test rig: a pump at a commanded speed, a line, an orifice as load"
  // The model that you believe in. What was commanded on the rig are inputs; what was measured are variables.
  // Values in this text are in SI units: Pa, m3, m3/s, rad/s. Columns of recordings may have others: see {{name}}.toml.
  Interfaces.RealInput w_ref(unit = "rad/s", nominal = 100) "Command: speed of the pump";

  inner Oil.Fluid oil "Oil";
  Mechanical.Rotational.Speed motor "Servo motor, holds the commanded speed";
  Hydraulic.Pump pump(V = 10e-6) "10 ml per revolution; port_a is the high side";
  Hydraulic.Tank suction "Where the pump takes its oil from";
  Hydraulic.Volume line(V = 0.5e-3, p_start = 20e5) "Oil between pump, valve and load";
  Hydraulic.ReliefValve relief(p_set = 250e5, q_nom = 0.5e-3) "Opens at 250 bar";
  Hydraulic.Orifice load(A = 2e-6) "The load: 2 mm2";
  Hydraulic.Tank return_tank "Where valve and load give their oil to";

  Real p(unit = "Pa", nominal = 1e7) "Measured: pressure of the line";
  Real q(unit = "m3/s", nominal = 1e-4) "Measured: flow through the load";
equation
  connect(w_ref, motor.w_ref);
  connect(motor.flange, pump.flange);
  connect(suction.port, pump.port_b);
  connect(pump.port_a, line.port);
  connect(line.port, relief.port_a);
  connect(line.port, load.port_a);
  connect(relief.port_b, return_tank.port);
  connect(load.port_b, return_tank.port);
  p = line.p;
  q = load.q;
end {{Name}};
