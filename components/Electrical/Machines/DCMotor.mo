within Electrical.Machines;
model DCMotor "DC motor with permanent magnets"
  Interfaces.Pin p "Positive pin";
  Interfaces.Pin n "Negative pin";
  Interfaces.RotationalFlange flange "Shaft; the inertia of the rotor is a component of its own";
  parameter SI.Resistance R(min = 1e-6) = 1 "Armature resistance";
  parameter SI.Inductance L(min = 1e-9) = 1e-3 "Armature inductance";
  parameter SI.ElectricalTorqueConstant k(min = 0) = 0.1 "Torque constant";
  SI.Current i(start = 0) "Current";
  SI.Torque T_e "Torque";
  SI.AngularVelocity w "Speed";
equation
  assert(R > 0 and L > 0, "Resistance R and inductance L must be positive");
  w = der(flange.phi);
  p.i = i;
  n.i = -i;
  p.v - n.v = R*i + L*der(i) + k*w;
  T_e = k*i;
  flange.tau = -T_e;
  annotation(Documentation(info = "<html><p><code>v = R i + L di/dt + k w</code>, <code>T = k i</code>. Armature reaction and brushes are left out. Valid without field weakening. Source: P. C. Krause, Analysis of Electric Machinery, chapter 2.</p></html>"));
end DCMotor;
