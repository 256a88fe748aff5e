within Thermal.Examples;
model OilMassExample "Oil warmed by a throttle"
  inner Oil.ISOVG46 oil(useTemperatureInput = true) "Oil";
  OilMass heat;
  Hydraulic.PressureSource source(p = 100e5);
  Hydraulic.LaminarGap gap(G = 1e-11, useHeatPort = true);
  Hydraulic.Tank tank;
equation
  connect(source.port, gap.port_a);
  connect(gap.port_b, tank.port);
  connect(gap.heatPort, heat.port);
  connect(heat.T, oil.T_in);
  annotation(experiment(StartTime = 0, StopTime = 1200, Interval = 2.4, Tolerance = 1e-6));
end OilMassExample;
