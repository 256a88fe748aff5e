within Signal;
block Not "Logical not"
  Interfaces.BooleanInput u "Input";
  Interfaces.BooleanOutput y "Output";
equation
  y = not u;
end Not;
