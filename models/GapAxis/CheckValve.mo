within GapAxis;
model CheckValve "Anticavitation valve of the comparison"
  extends SoftValve;
end CheckValve;
