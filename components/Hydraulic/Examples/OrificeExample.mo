within Hydraulic.Examples;
model OrificeExample "Flow over pressure difference, through zero"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Ramp ramp(height = 20e5, duration = 1, offset = 90e5);
  PressureSource source(useInput = true);
  Orifice orifice(A = 1e-6);
  Tank tank(p = 100e5);
equation
  connect(ramp.y, source.p_in);
  connect(source.port, orifice.port_a);
  connect(orifice.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end OrificeExample;
