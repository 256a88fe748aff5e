within Mechanical.Translational;
model SpringDamper "Linear spring and damper in parallel"
  extends Bases.Compliant;
  parameter SI.TranslationalSpringConstant c(min = 0, max = 1e12, nominal = 1e6) = 1e6 "Stiffness";
  parameter SI.TranslationalDampingConstant d(min = 0, max = 1e10, nominal = 1e3) = 1e3 "Damping";
  parameter SI.Position s_rel0 = 0 "Relative position without force at rest";
  SI.Velocity v_rel(nominal = 0.1) "Relative speed";
equation
  assert(c >= 0 and d >= 0, "Stiffness c and damping d must not be negative");
  v_rel = der(s_rel);
  f = c*(s_rel - s_rel0) + d*v_rel;
  annotation(Documentation(info = "<html><p>Spring and damper side by side; the damper alone loses power.</p></html>"));
end SpringDamper;
