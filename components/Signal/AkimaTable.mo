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
  annotation(Documentation(info = "<html><p>A smooth curve through the points of the table, with local slopes that do not overshoot at corners. The abscissae must grow. Source: H. Akima, J. ACM 17 (1970) 589.</p></html>"));
end AkimaTable;
