within Hydraulic.Examples;
model ChargeUnitExample "A charge pump replaces the leakage of a closed circuit"
  inner Oil.ISOVG46 oil "Oil";
  Mechanical.Rotational.ConstantSpeed drive(w_fixed = 100);
  ChargeUnit charge;
  Volume side_a(V = 1e-3, p_start = 100e5);
  Volume side_b(V = 1e-3, p_start = 20e5);
  Orifice leak_a(A = 0.5e-6);
  Orifice leak_b(A = 0.5e-6);
  Tank tank;
equation
  connect(drive.flange, charge.flange);
  connect(charge.port_a, side_a.port);
  connect(charge.port_b, side_b.port);
  connect(charge.port_tank, tank.port);
  connect(side_a.port, leak_a.port_a);
  connect(side_b.port, leak_b.port_a);
  connect(leak_a.port_b, tank.port);
  connect(leak_b.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end ChargeUnitExample;
