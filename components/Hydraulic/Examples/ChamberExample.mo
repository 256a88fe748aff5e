within Hydraulic.Examples;
model ChamberExample "A piston bounces on a closed chamber"
  inner Oil.ISOVG46 oil "Oil";
  Chamber chamber(A = 1e-3, V_0 = 1e-4, p_start = 20e5);
  Plug plug;
  Mechanical.Translational.Mass mass(m = 100);
  Mechanical.Translational.ConstantForce weight(f_constant = -2500);
equation
  connect(chamber.port, plug.port);
  connect(chamber.flange, mass.flange_a);
  connect(mass.flange_b, weight.flange);
  annotation(experiment(StartTime = 0, StopTime = 0.5, Interval = 0.001, Tolerance = 1e-6));
end ChamberExample;
