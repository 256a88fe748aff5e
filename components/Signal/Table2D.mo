within Signal;
block Table2D "Surface given by a matrix, bilinear between its points"
  extends Bases.TwoToOne;
  parameter Real table[:, :] = [0, 0, 1; 0, 0, 0; 1, 0, 1] "First column u1 from row 2 on, first row u2 from column 2 on, values between";
equation
  assert(size(table, 1) > 2 and size(table, 2) > 2, "A table of two arguments needs at least two of each");
  for i in 3:size(table, 1) loop
    assert(table[i, 1] > table[i - 1, 1], "The first argument of the table must increase");
  end for;
  for j in 3:size(table, 2) loop
    assert(table[1, j] > table[1, j - 1], "The second argument of the table must increase");
  end for;
  y = Functions.interpolate2(table[2:end, 1], table[1, 2:end], table[2:end, 2:end], u1, u2);
  annotation(Documentation(info = "<html><p>Bilinear between the points of the map; beyond its edges the values of the edge hold. Both axes must grow.</p></html>"));
end Table2D;
