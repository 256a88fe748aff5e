within Signal.Functions;
function interpolate "Linear interpolation in a table of two columns"
  input Real table[:, 2] "Abscissa, ordinate; abscissae strictly increasing";
  input Real u "Abscissa asked for";
  input Boolean hold = true "true: the end values hold outside, false: the end segments go on";
  output Real y "Ordinate";
protected
  Integer n = size(table, 1);
  Integer i;
  Real x;
algorithm
  x := if hold then min(max(u, table[1, 1]), table[n, 1]) else u;
  i := 1;
  for k in 2:n - 1 loop
    if x >= table[k, 1] then
      i := k;
    end if;
  end for;
  y := table[i, 2] + (table[i + 1, 2] - table[i, 2])*((x - table[i, 1])/(table[i + 1, 1] - table[i, 1]));
  annotation(Documentation(info = "<html><p>The segment is searched from the start, so that tables of up to some hundred rows are fast enough.</p></html>"));
end interpolate;
