within Mechanical.Rotational;
model Arm "Arm that turns about a level axis: inertia and weight, with a load at its end"
  Interfaces.RotationalFlange flange_a "Left flange";
  Interfaces.RotationalFlange flange_b "Right flange";
  parameter SI.Mass m(min = 0, max = 1e8, nominal = 10) = 10 "Mass of the arm";
  parameter SI.Length l(min = 1e-3, max = 1e3, nominal = 1) = 1 "Length of the arm";
  parameter SI.Length r_c(min = 0, max = 1e3, nominal = 0.5) = l/2 "Distance of the centre of mass of the arm from the axis";
  parameter SI.Inertia J_c(min = 1e-9, max = 1e8, nominal = 1) = max(m*l^2/12, 1e-9) "Moment of inertia of the arm about its centre of mass; of a slender rod m l^2/12";
  parameter SI.Mass m_load(min = 0, max = 1e8, nominal = 10) = 0 "Mass at the end of the arm";
  parameter SI.Angle phi_0(displayUnit = "deg") = 0 "Angle of the arm above the horizontal where the angle of the flanges is 0";
  parameter SI.Acceleration g(min = 0, max = 100) = Modelica.Constants.g_n "Acceleration of gravity";
  Inertia rotor(final J = J) "Inertia about the axis; it has the start values of the arm";
  SI.Angle angle(displayUnit = "deg") "Angle above the horizontal";
  SI.Torque tau_g(nominal = 100) "Torque of the weight, against the positive direction";
  SI.Height height(nominal = 1) "Height of the end of the arm above the axis";
  final parameter SI.Inertia J = J_c + m*r_c^2 + m_load*l^2 "Moment of inertia about the axis";
protected
  Torque weight "Weight";
equation
  assert(m >= 0 and m_load >= 0 and l > 0 and J_c > 0, "The masses must not be negative, the length l and the inertia J_c must be positive");
  angle = phi_0 + rotor.phi;
  tau_g = g*(m*r_c + m_load*l)*cos(angle);
  height = l*sin(angle);
  weight.tau = -tau_g;
  connect(weight.flange, rotor.flange_b);
  connect(flange_a, rotor.flange_a);
  connect(flange_b, rotor.flange_b);
  annotation(Documentation(info = "<html><p><code>J dw/dt = tau_a + tau_b - g (m r_c + m_load l) cos(angle)</code> with <code>J = J_c + m r_c^2 + m_load l^2</code>: a boom, a robot's arm, an unbalanced table. Exact for all angles; keeps energy. The axis is level and at rest. Start values: <code>Arm arm(rotor(phi(start = 0.5)))</code>.</p>
<p>Source: J. L. Meriam and L. G. Kraige, Engineering Mechanics: Dynamics, 2012, section 6/4.</p></html>"));
end Arm;
