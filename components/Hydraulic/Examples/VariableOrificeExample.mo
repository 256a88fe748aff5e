within Hydraulic.Examples;
model VariableOrificeExample "An orifice opens against constant pressure"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Ramp ramp(height = 1.2, duration = 1, offset = -0.1);
  PressureSource source(p = 100e5);
  VariableOrifice orifice;
  Tank tank;
equation
  connect(ramp.y, orifice.u);
  connect(source.port, orifice.port_a);
  connect(orifice.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end VariableOrificeExample;
