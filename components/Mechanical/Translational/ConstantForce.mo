within Mechanical.Translational;
model ConstantForce "Constant force acting on a flange"
  Interfaces.TranslationalFlange flange "Flange";
  parameter SI.Force f_constant = 1 "Force that accelerates the component joined";
equation
  flange.f = -f_constant;
end ConstantForce;
