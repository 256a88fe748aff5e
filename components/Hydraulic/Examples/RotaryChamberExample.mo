within Hydraulic.Examples;
model RotaryChamberExample "A vane turned to and fro against a closed chamber"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Sine course(amplitude = 5e-3, f = 2);
  Mechanical.Rotational.Position drive;
  RotaryChamber chamber(p_start = 100e5);
  Plug plug;
equation
  connect(course.y, drive.phi_ref);
  connect(drive.flange, chamber.flange);
  connect(chamber.port, plug.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end RotaryChamberExample;
