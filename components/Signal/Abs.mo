within Signal;
block Abs "Magnitude"
  extends Bases.OneToOne;
equation
  y = abs(u);
  annotation(Documentation(info = "<html><p><code>y = |u|</code>; the change of sign is an event. A pick-up that cannot tell the direction is such a block.</p></html>"));
end Abs;
