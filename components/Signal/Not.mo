within Signal;
block Not "Logical not"
  Interfaces.BooleanInput u "Input";
  Interfaces.BooleanOutput y "Output";
equation
  y = not u;
  annotation(Documentation(info = "<html><p>True where the input is not.</p></html>"));
end Not;
