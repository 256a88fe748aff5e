within Hydraulic.Examples;
model PlungerCylinderExample "A plunger lifts a load to its stop; the load brings it back"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 80e5);
  Tank tank;
  Valve43Centre valve(q_nom = 2e-4, centre = SpoolCentre.closed);
  PlungerCylinder cylinder(d = 0.05, stroke = 0.2, p_start = 55e5);
  Mechanical.Translational.ConstantForce load(f_constant = -10000);
  Plug plug;
  Signal.TimeTable command(table = [0, 0; 0.1, 0; 0.15, 1; 1.4, 1; 1.45, 0; 1.6, 0; 1.65, -1; 3.3, -1]);
equation
  connect(source.port, valve.port_P);
  connect(valve.port_T, tank.port);
  connect(valve.port_A, cylinder.port);
  connect(valve.port_B, plug.port);
  connect(load.flange, cylinder.flange);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 3.3, Interval = 0.005, Tolerance = 1e-6));
end PlungerCylinderExample;
