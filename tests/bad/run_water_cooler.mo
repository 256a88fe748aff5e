//! run
//! E503 at 5: "needs oil that carries heat"
model M
  inner Oil.Fluid oil;
  Hydraulic.WaterCooler cooler;
  Hydraulic.FlowSource source;
  Hydraulic.Tank tank;
equation
  connect(source.port, cooler.port_a);
  connect(cooler.port_b, tank.port);
end M;
