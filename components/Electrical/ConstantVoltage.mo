within Electrical;
model ConstantVoltage "Constant voltage"
  extends Bases.OnePort;
  parameter SI.Voltage V = 1 "Voltage";
equation
  v = V;
end ConstantVoltage;
