within Signal;
block Abs "Magnitude"
  extends Bases.OneToOne;
equation
  y = abs(u);
end Abs;
