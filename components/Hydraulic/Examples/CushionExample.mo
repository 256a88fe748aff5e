within Hydraulic.Examples;
model CushionExample "A mass brought to rest before the end of the stroke"
  inner Oil.ISOVG46 oil "Oil";
  Cylinder cylinder(A_1 = 20e-4, A_2 = 20e-4, stroke = 0.2, s_start = 0.1, v_start = -1, p_1_start = 10e5, p_2_start = 10e5);
  Mechanical.Translational.Mass load(m = 100, s(start = 0.1, fixed = false), v(start = -1, fixed = false));
  Cushion cushion;
  Tank tank_1(p = 10e5);
  Tank tank_2(p = 10e5);
  Orifice open(A = 5e-5);
equation
  connect(cylinder.flange, load.flange_a);
  connect(cylinder.port_1, cushion.port_a);
  connect(cushion.port_b, tank_1.port);
  connect(cushion.flange, cylinder.flange);
  connect(cylinder.port_2, open.port_a);
  connect(open.port_b, tank_2.port);
  annotation(experiment(StartTime = 0, StopTime = 0.5, Interval = 0.001, Tolerance = 1e-6));
end CushionExample;
