within Signal;
block VariableLimiter "Limits given by signals"
  extends Bases.OneToOne;
  Interfaces.RealInput limit1 "Upper limit";
  Interfaces.RealInput limit2 "Lower limit";
equation
  y = smooth(0, if u > limit1 then limit1 elseif u < limit2 then limit2 else u);
  annotation(Documentation(info = "<html><p>Limits given by signals; the upper one must not lie below the lower one.</p></html>"));
end VariableLimiter;
