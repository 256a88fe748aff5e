within Signal;
block Or "Logical or"
  Interfaces.BooleanInput u1 "First input";
  Interfaces.BooleanInput u2 "Second input";
  Interfaces.BooleanOutput y "Output";
equation
  y = u1 or u2;
  annotation(Documentation(info = "<html><p>True where one of the inputs is.</p></html>"));
end Or;
