model Belt "Mass held by a spring on a moving belt: stick-slip"
  import Modelica.Units.SI;
  parameter SI.Mass m(min = 1e-3) = 1 "Mass";
  parameter SI.TranslationalSpringConstant k(min = 0) = 100 "Spring";
  parameter SI.TranslationalDampingConstant c(min = 0) = 0.2 "Damper";
  parameter SI.Velocity v_belt = 0.1 "Speed of the belt";
  parameter SI.Force F_s(min = 0) = 4 "Greatest holding force";
  parameter SI.Force F_c(min = 0) = 3 "Coulomb friction";
  parameter SI.Velocity v_s(min = 1e-6) = 0.1 "Stribeck speed";
  Mechanical.Translational.Fixed wall "Wall";
  Mechanical.Translational.SpringDamper spring(c = k, d = c) "Spring";
  Mechanical.Translational.Mass mass(m = m) "Mass";
  Mechanical.Translational.ConstantSpeed belt(v_fixed = v_belt) "Belt";
  Mechanical.Translational.Friction friction(f_c = F_c, f_s = F_s, v_s = v_s) "Friction between mass and belt";
  SI.Position x(nominal = 0.01) "Position of the mass";
  SI.Velocity v(nominal = 0.1) "Velocity of the mass";
  SI.Force F "Friction force that drives the mass";
equation
  connect(wall.flange, spring.flange_a);
  connect(spring.flange_b, mass.flange_a);
  connect(mass.flange_b, friction.flange_a);
  connect(friction.flange_b, belt.flange);
  x = mass.s;
  v = mass.v;
  F = friction.f;
  annotation(
    experiment(StartTime = 0, StopTime = 20, Interval = 0.01, Tolerance = 1e-6),
    Documentation(info = "<html><p><code>m dv/dt = -k x - c v + F</code>, the friction <code>F_c + (F_s - F_c) exp(-((v_belt - v)/v_s)^2)</code> while sliding. Starts at rest, sliding; sticks 27 times in 20 s.
Source of the model: B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083.</p></html>"));
end Belt;
