within Pneumatic.Examples;
model VolumeExample "A volume filled by a choked flow, cooled by its wall"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  Orifice orifice(C = 0.5e-8);
  Volume volume(V = 2e-3);
  Thermal.ThermalConductor wall(G = 0.5);
  Thermal.FixedTemperature room;
equation
  connect(supply.port, orifice.port_a);
  connect(orifice.port_b, volume.port);
  connect(volume.heatPort, wall.port_a);
  connect(wall.port_b, room.port);
  annotation(experiment(StartTime = 0, StopTime = 10, Interval = 0.02, Tolerance = 1e-6));
end VolumeExample;
