within Signal;
block And "Logical and"
  Interfaces.BooleanInput u1 "First input";
  Interfaces.BooleanInput u2 "Second input";
  Interfaces.BooleanOutput y "Output";
equation
  y = u1 and u2;
  annotation(Documentation(info = "<html><p>True where both inputs are.</p></html>"));
end And;
