within Signal;
block Feedback "Difference u1 - u2"
  extends Bases.TwoToOne;
equation
  y = u1 - u2;
end Feedback;
