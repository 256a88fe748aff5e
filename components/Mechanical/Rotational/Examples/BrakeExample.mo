within Mechanical.Rotational.Examples;
model BrakeExample "A brake stops a rotor under load and holds it"
  ConstantTorque drive(tau_constant = 1);
  Inertia mass(J = 1, w(start = 10));
  Brake brake(fn_max = 20, cgeo = 0.5);
  Signal.Pulse engage(period = 10, width = 0.5, startTime = 1);
equation
  connect(engage.y, brake.f_normalized);
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, brake.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 10, Interval = 0.02, Tolerance = 1e-6));
end BrakeExample;
