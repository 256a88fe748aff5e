within Signal.Bases;
partial block Source "One output"
  Interfaces.RealOutput y "Output";
end Source;
