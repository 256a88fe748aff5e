within Effects;
model TranslationalConstantForce "A constant load"
  extends Interfaces.TranslationalShunt;
  parameter SI.Force F_0(nominal = 100) = 0 "Load, against positive motion";
equation
  f = F_0;
  annotation(__bramah(family = "constant_force", id = "E27", coefficients = {"F_0"}));
end TranslationalConstantForce;
