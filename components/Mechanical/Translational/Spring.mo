within Mechanical.Translational;
model Spring "Linear spring"
  extends Bases.Compliant;
  parameter SI.TranslationalSpringConstant c(min = 0, max = 1e12, nominal = 1e6) = 1e6 "Stiffness";
  parameter SI.Position s_rel0 = 0 "Relative position without force";
equation
  assert(c >= 0, "The stiffness c must not be negative");
  f = c*(s_rel - s_rel0);
  annotation(Documentation(info = "<html><p>Linear, without damping; keeps energy.</p></html>"));
end Spring;
