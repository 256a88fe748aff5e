within Electrical;
model Ground "Ground"
  Interfaces.Pin p "Pin";
equation
  p.v = 0;
end Ground;
