within Signal.Bases;
partial block TwoToOne "Two inputs, one output"
  Interfaces.RealInput u1 "First input";
  Interfaces.RealInput u2 "Second input";
  Interfaces.RealOutput y "Output";
end TwoToOne;
