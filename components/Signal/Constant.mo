within Signal;
block Constant "Constant signal"
  extends Bases.Source;
  parameter Real k = 1 "Value";
equation
  y = k;
  annotation(Documentation(info = "<html><p>The same value always.</p></html>"));
end Constant;
