within Signal;
block Switch "Chooses one of two signals"
  Interfaces.RealInput u1 "Passed where u2 is true";
  Interfaces.BooleanInput u2 "Choice";
  Interfaces.RealInput u3 "Passed where u2 is false";
  Interfaces.RealOutput y "Output";
equation
  y = if u2 then u1 else u3;
  annotation(Documentation(info = "<html><p>One of two inputs, by a condition; switching is an event.</p></html>"));
end Switch;
