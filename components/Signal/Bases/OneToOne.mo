within Signal.Bases;
partial block OneToOne "One input, one output"
  Interfaces.RealInput u "Input";
  Interfaces.RealOutput y "Output";
end OneToOne;
