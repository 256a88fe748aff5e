within Signal;
block AkimaTable2D "Surface given by a matrix, smooth between its points"
  extends Bases.TwoToOne;
  extends Bases.Tabular;
  parameter Real table[:, :] = [0, 0, 1; 0, 0, 0; 1, 0, 1] "First column u1 from row 2 on, first row u2 from column 2 on, values between";
  parameter Boolean hold = true "true: the values of the edge hold outside, false: the surface goes on straight";
  parameter Boolean guarded = false "true: a run that leaves the table stops with an error" annotation(Evaluate = true);
protected
  final parameter Integer n[2] = if fileName == "" then {size(table, 1), size(table, 2)} else Functions.tableSize(fileName, tableName) "Rows, columns";
  final parameter Real data[n[1], n[2]] = if fileName == "" then table else Functions.readTable(fileName, tableName, 2, n[1], n[2]) "The table in use";
equation
  assert(not guarded or u1 >= data[2, 1] and u1 <= data[end, 1], "The first input " + String(u1) + " lies outside the table, which goes from " + String(data[2, 1]) + " to " + String(data[end, 1]));
  assert(not guarded or u2 >= data[1, 2] and u2 <= data[1, end], "The second input " + String(u2) + " lies outside the table, which goes from " + String(data[1, 2]) + " to " + String(data[1, end]));
  assert(size(data, 1) > 2 and size(data, 2) > 2, "A table of two arguments needs at least two of each");
  for i in 3:size(data, 1) loop
    assert(data[i, 1] > data[i - 1, 1], "The first argument of the table must increase");
  end for;
  for j in 3:size(data, 2) loop
    assert(data[1, j] > data[1, j - 1], "The second argument of the table must increase");
  end for;
  y = Functions.akima2(data[2:end, 1], data[1, 2:end], data[2:end, 2:end],
    if hold then min(max(u1, data[2, 1]), data[end, 1]) else u1,
    if hold then min(max(u2, data[1, 2]), data[1, end]) else u2);
  annotation(Documentation(info = "<html><p>A smooth surface through the points of the map: Akima's curves in both directions, which do not overshoot at corners. With <code>guarded</code>, leaving the table is an error. Both axes must grow. For maps whose slopes matter, such as efficiencies that a control follows; bilinear is <code>Table2D</code>. Source: H. Akima, J. ACM 17 (1970) 589. A table may also come from a file, see <code>Functions.readTable</code>.</p></html>"));
end AkimaTable2D;
