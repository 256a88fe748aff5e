within Mechanical.Rotational.Examples;
model CrankExample "A flywheel drives a slider, straight and with an offset; a motor drives one to and fro"
  Inertia flywheel(J = 0.05, w(start = 20));
  Crank straight(r = 0.05, l = 0.15);
  Translational.Mass slider(m = 5, s(stateSelect = StateSelect.avoid), v(stateSelect = StateSelect.avoid));
  Signal.Sine sine(amplitude = 4, f = 1);
  Position motor;
  Crank offset(r = 0.05, l = 0.15, e = 0.03);
  Translational.Mass slider2(m = 5, s(stateSelect = StateSelect.avoid), v(stateSelect = StateSelect.avoid));
equation
  connect(flywheel.flange_b, straight.flangeR);
  connect(straight.flangeT, slider.flange_a);
  connect(sine.y, motor.phi_ref);
  connect(motor.flange, offset.flangeR);
  connect(offset.flangeT, slider2.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.002, Tolerance = 1e-7));
end CrankExample;
