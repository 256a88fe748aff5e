within Signal;
block And "Logical and"
  Interfaces.BooleanInput u1 "First input";
  Interfaces.BooleanInput u2 "Second input";
  Interfaces.BooleanOutput y "Output";
equation
  y = u1 and u2;
end And;
