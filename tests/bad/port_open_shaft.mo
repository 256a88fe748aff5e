//! E103 at 4: "`pump.flange` is not connected"
model M
  inner Oil.Fluid oil;
  Hydraulic.Pump pump;
  Hydraulic.Tank suction;
  Hydraulic.Tank delivery;
equation
  connect(suction.port, pump.port_b);
  connect(pump.port_a, delivery.port);
end M;
