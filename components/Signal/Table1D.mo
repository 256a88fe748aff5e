within Signal;
block Table1D "Curve given by a matrix, linear between its points"
  extends Bases.OneToOne;
  parameter Real table[:, 2] = [0, 0; 1, 1] "Abscissa, ordinate; abscissae strictly increasing";
  parameter Boolean hold = true "true: the end values hold outside, false: the end segments go on";
equation
  assert(size(table, 1) > 1, "A table needs at least two rows");
  for i in 2:size(table, 1) loop
    assert(table[i, 1] > table[i - 1, 1], "The abscissae of the table must increase");
  end for;
  y = Functions.interpolate(table, u, hold);
  annotation(Documentation(info = "<html><p>Straight lines through the points of the table; beyond its ends the last line goes on, or the last value holds. The abscissae must grow.</p></html>"));
end Table1D;
