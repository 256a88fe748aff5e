within Effects;
model CommandGain "The command acts with a wrong scale"
  extends Interfaces.Command;
  parameter Real k(unit = "1", nominal = 0.05) = 0 "Relative error of the scale";
equation
  y = u + k*u;
  annotation(__bramah(family = "command_gain", id = "E39", coefficients = {"k"}, measured = "yes"));
end CommandGain;
