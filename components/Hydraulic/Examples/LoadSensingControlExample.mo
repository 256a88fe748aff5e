within Hydraulic.Examples;
model LoadSensingControlExample "A load-sensing pump feeds a metering orifice against a load that rises"
  inner Oil.ISOVG46 oil "Oil";
  Mechanical.Rotational.ConstantSpeed motor(w_fixed = 157);
  Pump pump(V = 45e-6, useInput = true);
  PumpControl.LoadSensingControl control(p_set = 200e5, V = pump.V, u_start = 0.2);
  Volume volume(V = 5e-4, p_start = 40e5);
  VariableOrifice metering(A_max = 1.2e-5);
  Signal.Trapezoid opening(amplitude = 0.6, offset = 0.2, rising = 0.1, holding = 0.5, falling = 0.1, startTime = 0.3);
  PressureSource load(useInput = true);
  Signal.Ramp course(offset = 20e5, height = 170e5, duration = 1.6, startTime = 0.2);
  Tank tank;
equation
  connect(motor.flange, pump.flange);
  connect(pump.port_b, tank.port);
  connect(pump.port_a, volume.port);
  connect(control.port_p, volume.port);
  connect(control.u, pump.u);
  connect(volume.port, metering.port_a);
  connect(opening.y, metering.u);
  connect(metering.port_b, load.port);
  connect(control.port_LS, load.port);
  connect(course.y, load.p_in);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end LoadSensingControlExample;
