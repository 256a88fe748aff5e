within Mechanical.Rotational;
model SpringDamper "Linear spring and damper in parallel"
  extends Bases.Compliant;
  parameter SI.RotationalSpringConstant c(min = 0, max = 1e12, nominal = 1e4) = 1e4 "Stiffness";
  parameter SI.RotationalDampingConstant d(min = 0, max = 1e10, nominal = 1) = 1 "Damping";
  parameter SI.Angle phi_rel0 = 0 "Relative angle without torque at rest";
  SI.AngularVelocity w_rel(nominal = 10) "Relative speed";
equation
  assert(c >= 0 and d >= 0, "Stiffness c and damping d must not be negative");
  w_rel = der(phi_rel);
  tau = c*(phi_rel - phi_rel0) + d*w_rel;
  annotation(Documentation(info = "<html><p>Spring and damper side by side; the damper alone loses power.</p></html>"));
end SpringDamper;
