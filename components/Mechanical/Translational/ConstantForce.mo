within Mechanical.Translational;
model ConstantForce "Constant force acting on a flange"
  Interfaces.TranslationalFlange flange "Flange";
  parameter SI.Force f_constant = 1 "Force that accelerates the component joined";
equation
  flange.f = -f_constant;
  annotation(Documentation(info = "<html><p>Positive values accelerate what is joined in the positive direction.</p></html>"));
end ConstantForce;
