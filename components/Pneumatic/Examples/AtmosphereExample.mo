within Pneumatic.Examples;
model AtmosphereExample "A vacuum vessel breathes in"
  inner Gas gas "Air";
  Atmosphere atmosphere;
  Orifice orifice(C = 0.5e-8);
  Volume vessel(V = 1e-3, p_start = 1e4);
equation
  connect(atmosphere.port, orifice.port_a);
  connect(orifice.port_b, vessel.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end AtmosphereExample;
