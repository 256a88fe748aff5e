within Signal;
block TimeTable "Polygon over time, given by a matrix"
  extends Bases.Source;
  extends Bases.Tabular;
  parameter Real table[:, 2] = [0, 0; 1, 1] "Time, value; two rows of equal time make a jump";
  parameter Real offset = 0 "Added to the values";
  parameter SI.Time startTime = 0 "Time of the table's zero";
  parameter Boolean periodic = false "true: the table is repeated, as a cycle of work";
protected
  discrete Real y_0(start = 0, fixed = true) "Value at the begin of the segment";
  discrete Real slope(start = 0, fixed = true) "Slope of the segment";
  discrete Real t_0(start = 0, fixed = true) "Begin of the segment, in the table's time";
  discrete Real t_next(start = -1e60, fixed = true) "Next corner, in the table's time";
  discrete Real t_round(start = 0, fixed = true) "Begin of the present round, in the table's time, less the first time of the table";
  discrete Real t_at(start = 0, fixed = true) "Where the segment is looked for, in the table's time";
  final parameter SI.Time T = data[end, 1] - data[1, 1] "Length of a round";
  final parameter Integer n[2] = if fileName == "" then {size(table, 1), size(table, 2)} else Functions.tableSize(fileName, tableName) "Rows, columns";
  final parameter Real data[n[1], 2] = if fileName == "" then table else Functions.readTable(fileName, tableName, 0, n[1], 2) "The table in use";
equation
  assert(size(data, 1) > 1, "A table over time needs at least two rows");
  assert(not periodic or data[end, 1] > data[1, 1], "A table that is repeated must last some time");
  for i in 2:size(data, 1) loop
    assert(data[i, 1] >= data[i - 1, 1], "The times of the table must not decrease");
  end for;
  when {initial(), time - startTime - pre(t_round) >= pre(t_next)} then
    t_round = if not periodic then 0
      elseif initial() then T*floor((time - startTime - data[1, 1])/T)
      elseif pre(t_next) >= data[end, 1] then pre(t_round) + T
      else pre(t_round);
    t_at = if t_round > pre(t_round) and not initial() then data[1, 1] else max(time - startTime - t_round, pre(t_next));
    (y_0, slope, t_0, t_next) = Functions.segment(data, t_at);
  end when;
  y = offset + y_0 + slope*(time - startTime - t_round - t_0);
  annotation(Documentation(info = "<html><p>Linear between the corners, constant outside, or repeated where it is <code>periodic</code>; every corner is an event, so that integrators pass it exactly. A table may also come from a file, see <code>Functions.readTable</code>.</p></html>"));
end TimeTable;
