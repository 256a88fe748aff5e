within Signal.Functions;
function segment "Segment of a polygon in time: value and slope there, time of the next corner"
  input Real table[:, 2] "Time, value; times not decreasing";
  input Real t "Time";
  output Real y_0 "Value at t_0";
  output Real slope "Slope; 0 outside the table";
  output Real t_0 "Begin of the segment";
  output Real t_next "Next corner, or a time never reached";
protected
  Integer n = size(table, 1);
  Integer i;
algorithm
  i := 0;
  for k in 1:n loop
    if t >= table[k, 1] then
      i := k;
    end if;
  end for;
  if i == 0 then
    y_0 := table[1, 2];
    slope := 0;
    t_0 := t;
    t_next := table[1, 1];
  elseif i == n then
    y_0 := table[n, 2];
    slope := 0;
    t_0 := t;
    t_next := 1e60;
  else
    y_0 := table[i, 2];
    slope := (table[i + 1, 2] - table[i, 2])/(table[i + 1, 1] - table[i, 1]);
    t_0 := table[i, 1];
    t_next := table[i + 1, 1];
  end if;
  annotation(Documentation(info = "<html><p>For a course over time: the value and the slope from a corner on, and when the next corner comes, so that each corner is one event.</p></html>"));
end segment;
