//! E503 at 4: "Volumetric efficiencies must lie from 0 to 1"
model M
  inner Oil.ISOVG46 oil;
  Hydraulic.EfficiencyMapMachine pump(eta_v = [0, 1e6, 1e7; 10, 0.9, 0.8; 100, 0.95, 1.2]);
  Mechanical.Rotational.ConstantSpeed drive(w_fixed = 50);
  Hydraulic.Tank tank;
  Hydraulic.PressureSource load(p = 1e7);
equation
  connect(drive.flange, pump.flange);
  connect(pump.port_b, tank.port);
  connect(pump.port_a, load.port);
end M;
