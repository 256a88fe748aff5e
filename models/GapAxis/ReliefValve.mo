within GapAxis;
model ReliefValve "Relief valve of the comparison"
  extends SoftValve;
end ReliefValve;
