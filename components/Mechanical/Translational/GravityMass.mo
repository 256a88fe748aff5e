within Mechanical.Translational;
model GravityMass "Mass on an incline, or moved up and down, with its weight"
  Interfaces.TranslationalFlange flange_a "Left flange";
  Interfaces.TranslationalFlange flange_b "Right flange";
  parameter SI.Mass m(min = 1e-5, max = 1e9, nominal = 1) = 1 "Mass";
  parameter SI.Angle slope(displayUnit = "deg", min = -Modelica.Constants.pi/2, max = Modelica.Constants.pi/2) = Modelica.Constants.pi/2 "Angle of the positive direction above the horizontal: pi/2 upwards, -pi/2 downwards, 0 level";
  parameter SI.Acceleration g(min = 0, max = 100) = Modelica.Constants.g_n "Acceleration of gravity";
  Mass mass(final m = m) "Mass; it has the start values";
  Gravity weight(final m = m, final slope = slope, final g = g) "Weight along the path";
  SI.Height height(nominal = 1) "Height above position 0";
equation
  assert(m > 0, "The mass m must be positive");
  height = mass.s*sin(slope);
  connect(flange_a, mass.flange_a);
  connect(flange_b, mass.flange_b);
  connect(weight.flange, mass.flange_b);
  annotation(Documentation(info = "<html><p><code>m a = f_a + f_b - m g sin(slope)</code>: a slide on an incline, a platen, a hook. Keeps energy; friction of the guide: join <code>SupportFriction</code>. Start values: <code>GravityMass load(mass(s(start = 1)))</code>.</p></html>"));
end GravityMass;
