within Hydraulic.Examples;
model Valve43LoadSensingExample "A load-sensing pump and valve move a cylinder against a load; the pump idles in the middle"
  inner Oil.ISOVG46 oil "Oil";
  Mechanical.Rotational.ConstantSpeed motor(w_fixed = 157);
  Pump pump(V = 45e-6, useInput = true);
  PumpControl.LoadSensingControl control(p_set = 200e5, V = pump.V, u_start = 0.1);
  Volume line(V = 5e-4, p_start = 20e5);
  Volume sensing(V = 2e-5, p_start = 1e5);
  Valve43LoadSensing valve(q_P = 6e-4, q_T = 2e-4);
  Cylinder cylinder(A_1 = 12.57e-4, A_2 = 8.77e-4, stroke = 0.6, s_start = 0.1, p_1_start = 64e5, p_2_start = 1e5);
  Mechanical.Translational.ConstantForce load(f_constant = -8e3);
  Tank tank;
  Signal.TimeTable command(table = [0, 0; 0.3, 0; 0.4, 0.6; 0.9, 0.6; 1, 0; 1.3, 0; 1.4, -0.4; 1.7, -0.4; 1.8, 0; 2, 0]);
equation
  connect(motor.flange, pump.flange);
  connect(pump.port_b, tank.port);
  connect(pump.port_a, line.port);
  connect(control.port_p, line.port);
  connect(control.u, pump.u);
  connect(line.port, valve.port_P);
  connect(valve.port_T, tank.port);
  connect(valve.port_A, cylinder.port_1);
  connect(valve.port_B, cylinder.port_2);
  connect(valve.port_LS, sensing.port);
  connect(control.port_LS, sensing.port);
  connect(cylinder.flange, load.flange);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end Valve43LoadSensingExample;
