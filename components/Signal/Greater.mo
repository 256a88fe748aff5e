within Signal;
block Greater "True where the first input exceeds the second"
  Interfaces.RealInput u1 "First input";
  Interfaces.RealInput u2 "Second input";
  Interfaces.BooleanOutput y "Output";
equation
  y = u1 > u2;
  annotation(Documentation(info = "<html><p>Passing the other signal is an event. With noise take <code>Hysteresis</code> of the difference.</p></html>"));
end Greater;
