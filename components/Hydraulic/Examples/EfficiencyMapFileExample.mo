within Hydraulic.Examples;
model EfficiencyMapFileExample "A pump given by efficiency maps from a file, driven along its map"
  inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantDensity(beta_0 = 1.5e9)) "Oil";
  Signal.Ramp speed(offset = 20, height = 280, duration = 1);
  Mechanical.Rotational.Speed drive;
  EfficiencyMapMachine pump(V = 10e-6, fileName = "modelica://Hydraulic/Resources/efficiency.txt");
  Tank tank;
  PressureSource load(p = 150e5 + 101325);
  Real eta_v(unit = "1") "Volumetric efficiency";
  Real eta_m(unit = "1") "Hydromechanical efficiency";
equation
  connect(speed.y, drive.w_ref);
  connect(drive.flange, pump.flange);
  connect(pump.port_b, tank.port);
  connect(pump.port_a, load.port);
  eta_v = pump.Q_A/(pump.V*pump.w/(2*Modelica.Constants.pi));
  eta_m = pump.V/(2*Modelica.Constants.pi)*pump.dp/pump.T_sh;
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end EfficiencyMapFileExample;
