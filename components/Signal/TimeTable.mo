within Signal;
block TimeTable "Polygon over time, given by a matrix"
  extends Bases.Source;
  parameter Real table[:, 2] = [0, 0; 1, 1] "Time, value; two rows of equal time make a jump";
  parameter Real offset = 0 "Added to the values";
  parameter SI.Time startTime = 0 "Time of the table's zero";
protected
  discrete Real y_0(start = 0, fixed = true) "Value at the begin of the segment";
  discrete Real slope(start = 0, fixed = true) "Slope of the segment";
  discrete Real t_0(start = 0, fixed = true) "Begin of the segment, in the table's time";
  discrete Real t_next(start = -1e60, fixed = true) "Next corner, in the table's time";
equation
  assert(size(table, 1) > 1, "A table over time needs at least two rows");
  for i in 2:size(table, 1) loop
    assert(table[i, 1] >= table[i - 1, 1], "The times of the table must not decrease");
  end for;
  when {initial(), time - startTime >= pre(t_next)} then
    (y_0, slope, t_0, t_next) = Functions.segment(table, time - startTime);
  end when;
  y = offset + y_0 + slope*(time - startTime - t_0);
  annotation(Documentation(info = "<html><p>Linear between the corners, constant outside; every corner is an event, so that integrators pass it exactly.</p></html>"));
end TimeTable;
