within Signal;
block Table1D "Curve given by a matrix, linear between its points"
  extends Bases.OneToOne;
  extends Bases.Tabular;
  parameter Real table[:, 2] = [0, 0; 1, 1] "Abscissa, ordinate; abscissae strictly increasing";
  parameter Boolean hold = true "true: the end values hold outside, false: the end segments go on";
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
  y = Functions.interpolate(data, u, hold);
  annotation(Documentation(info = "<html><p>Straight lines through the points of the table; beyond its ends the last line goes on, or the last value holds. With <code>guarded</code>, leaving the table is an error. The abscissae must grow. A table may also come from a file, see <code>Functions.readTable</code>.</p></html>"));
end Table1D;
