within Signal;
block Constant "Constant signal"
  extends Bases.Source;
  parameter Real k = 1 "Value";
equation
  y = k;
end Constant;
