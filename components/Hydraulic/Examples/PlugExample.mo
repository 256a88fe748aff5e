within Hydraulic.Examples;
model PlugExample "A closed line keeps its pressure"
  inner Oil.ISOVG46 oil "Oil";
  Volume volume(V = 1e-3, p_start = 50e5);
  Orifice orifice;
  Plug plug;
equation
  connect(volume.port, orifice.port_a);
  connect(orifice.port_b, plug.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end PlugExample;
