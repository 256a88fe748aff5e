within Electrical;
model ConstantVoltage "Constant voltage"
  extends Bases.OnePort;
  parameter SI.Voltage V = 1 "Voltage";
equation
  v = V;
  annotation(Documentation(info = "<html><p>Gives any current at the voltage.</p></html>"));
end ConstantVoltage;
