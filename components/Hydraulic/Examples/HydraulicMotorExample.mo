within Hydraulic.Examples;
model HydraulicMotorExample "A motor fed at A, then at B, turns an inertia with a fan"
  inner Oil.ISOVG46 oil "Oil";
  FlowSource pump(useInput = true);
  Signal.TimeTable delivery(table = [0, 0; 0.2, 3e-4; 1, 3e-4; 1.6, -3e-4; 2.4, -3e-4]);
  Tank tank(p = 30e5) "Return under pressure, so that both sides stay filled";
  Volume side_A(V = 2e-4, p_start = 30e5);
  HydraulicMotor motor(V = 2e-5, machine(G = 5e-13));
  ReliefValve relief(p_set = 150e5) "Guards side A";
  Mechanical.Rotational.Inertia load(J = 0.02);
  Mechanical.Rotational.QuadraticLoad fan;
equation
  connect(delivery.y, pump.q_in);
  connect(pump.port, side_A.port);
  connect(side_A.port, motor.port_a);
  connect(motor.port_b, tank.port);
  connect(side_A.port, relief.port_a);
  connect(relief.port_b, tank.port);
  connect(motor.flange, load.flange_a);
  connect(load.flange_b, fan.flange);
  annotation(experiment(StartTime = 0, StopTime = 2.4, Interval = 0.004, Tolerance = 1e-6));
end HydraulicMotorExample;
