within Electrical;
model Ground "Ground"
  Interfaces.Pin p "Pin";
equation
  p.v = 0;
  annotation(Documentation(info = "<html><p>Zero potential; every circuit needs one.</p></html>"));
end Ground;
