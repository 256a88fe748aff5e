within Electrical.Examples;
model ExternalSupplyExample "A braking motor charges the capacitor of its DC link"
  Electrical.ConstantVoltage grid(V = 540) "Rectified grid";
  Electrical.Diode rectifier "It gives, and does not take back";
  Electrical.Capacitor link(C = 1e-3, v_start = 540) "DC link";
  Electrical.Ground ground;
  Drives.ServoMotor motor(externalSupply = true);
  Mechanical.Rotational.Inertia rotor(J = 5e-3);
  Signal.Pulse torque(amplitude = 12, period = 0.4, offset = -6);
equation
  connect(grid.p, rectifier.p);
  connect(rectifier.n, link.p);
  connect(link.n, grid.n);
  connect(ground.p, grid.n);
  connect(link.p, motor.dc_p);
  connect(link.n, motor.dc_n);
  connect(torque.y, motor.T_ref);
  connect(motor.flange, rotor.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 0.4, Interval = 1e-3, Tolerance = 1e-6));
end ExternalSupplyExample;
