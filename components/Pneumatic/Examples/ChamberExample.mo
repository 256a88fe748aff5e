within Pneumatic.Examples;
model ChamberExample "A closed chamber is compressed and released"
  inner Gas gas "Air";
  Chamber chamber(A = 1e-3, side = -1, V_0 = 1e-5, s_0 = 0.1);
  Plug plug;
  Mechanical.Translational.Speed drive(s(fixed = true));
  Signal.TimeTable speed(table = [0, 0; 0.1, 0; 0.2, 0.8; 0.3, 0; 0.6, 0; 0.7, -0.8; 0.8, 0; 1, 0]);
equation
  connect(chamber.port, plug.port);
  connect(speed.y, drive.v_ref);
  connect(drive.flange, chamber.flange);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end ChamberExample;
