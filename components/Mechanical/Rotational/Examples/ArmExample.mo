within Mechanical.Rotational.Examples;
model ArmExample "An arm swings a little about where it hangs, one goes round, one is lifted by a motor"
  Arm pendulum(m = 2, l = 1, phi_0 = -Modelica.Constants.pi/2, rotor(phi(start = 0.01)));
  Arm round(m = 2, l = 1, m_load = 1, phi_0 = -Modelica.Constants.pi/2, rotor(w(start = 8)));
  Arm boom(m = 20, l = 2, m_load = 5);
  Position servo;
  Signal.SmoothMove move(amplitude = 2, rising = 1.5, startTime = 0.5);
equation
  connect(move.y, servo.phi_ref);
  connect(servo.flange, boom.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.005, Tolerance = 1e-7));
end ArmExample;
