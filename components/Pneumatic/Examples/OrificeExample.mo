within Pneumatic.Examples;
model OrificeExample "The flow over the pressure downstream: choked, then falling, then reversed"
  inner Gas gas "Air";
  Reservoir upstream(p = 7e5);
  PressureSource downstream(useInput = true);
  Orifice orifice(C = 1e-8, b = 0.3);
  Signal.Ramp pressure(height = 8e5, duration = 1, offset = 1e5);
equation
  connect(pressure.y, downstream.p_in);
  connect(upstream.port, orifice.port_a);
  connect(orifice.port_b, downstream.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end OrificeExample;
