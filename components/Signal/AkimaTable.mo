within Signal;
block AkimaTable "Curve given by a matrix, smooth between its points"
  extends Bases.OneToOne;
  extends Bases.Tabular;
  parameter Real table[:, 2] = [0, 0; 1, 1] "Abscissa, ordinate; abscissae strictly increasing";
  parameter Boolean hold = false "true: the end values hold outside, false: the curve goes on straight";
  parameter Boolean guarded = false "true: a run that leaves the table stops with an error" annotation(Evaluate = true);
protected
  final parameter Integer n[2] = if fileName == "" then {size(table, 1), size(table, 2)} else Functions.tableSize(fileName, tableName) "Rows, columns";
  final parameter Real data[n[1], 2] = if fileName == "" then table else Functions.readTable(fileName, tableName, 1, n[1], 2) "The table in use";
equation
  assert(not guarded or u >= data[1, 1] and u <= data[end, 1], "The input " + String(u) + " lies outside the table, which goes from " + String(data[1, 1]) + " to " + String(data[end, 1]));
  assert(size(data, 1) > 1, "A table needs at least two rows");
  for i in 2:size(data, 1) loop
    assert(data[i, 1] > data[i - 1, 1], "The abscissae of the table must increase");
  end for;
  y = Functions.akima(data, if hold then min(max(u, data[1, 1]), data[end, 1]) else u);
  annotation(Documentation(info = "<html><p>A smooth curve through the points of the table, with local slopes that do not overshoot at corners. With <code>guarded</code>, leaving the table is an error. The abscissae must grow. Source: H. Akima, J. ACM 17 (1970) 589. A table may also come from a file, see <code>Functions.readTable</code>.</p></html>"));
end AkimaTable;
