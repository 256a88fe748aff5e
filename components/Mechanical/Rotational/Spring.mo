within Mechanical.Rotational;
model Spring "Linear spring"
  extends Bases.Compliant;
  parameter SI.RotationalSpringConstant c(min = 0, max = 1e12, nominal = 1e4) = 1e4 "Stiffness";
  parameter SI.Angle phi_rel0 = 0 "Relative angle without torque";
equation
  assert(c >= 0, "The stiffness c must not be negative");
  tau = c*(phi_rel - phi_rel0);
  annotation(Documentation(info = "<html><p>Linear, without damping; keeps energy.</p></html>"));
end Spring;
