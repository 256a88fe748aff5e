within Signal;
block AkimaTable "Curve given by a matrix, smooth between its points"
  extends Bases.OneToOne;
  parameter Real table[:, 2] = [0, 0; 1, 1] "Abscissa, ordinate; abscissae strictly increasing";
equation
  assert(size(table, 1) > 1, "A table needs at least two rows");
  for i in 2:size(table, 1) loop
    assert(table[i, 1] > table[i - 1, 1], "The abscissae of the table must increase");
  end for;
  y = Functions.akima(table, u);
end AkimaTable;
