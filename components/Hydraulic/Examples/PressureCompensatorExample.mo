within Hydraulic.Examples;
model PressureCompensatorExample "The drop over an orifice stays while the supply rises"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(useInput = true);
  Signal.Ramp supply(offset = 5e5, height = 200e5, duration = 1);
  PressureCompensator compensator(q_nom = 5e-4);
  Orifice metering(A = 1.5e-5);
  Tank tank;
equation
  connect(supply.y, source.p_in);
  connect(source.port, compensator.port_a);
  connect(compensator.port_b, metering.port_a);
  connect(compensator.port_y, metering.port_b);
  connect(metering.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end PressureCompensatorExample;
