within Signal.Functions;
function akima2 "Akima's interpolation in a table of two arguments: along the second in each row, then along the first"
  input Real x[:] "First argument, increasing";
  input Real y[:] "Second argument, increasing";
  input Real z[:, :] "Values, rows by x, columns by y";
  input Real u "First argument asked for";
  input Real v "Second argument asked for";
  output Real w "Value; straight beyond the edges";
protected
  Real row[size(y, 1), 2];
  Real column[size(x, 1), 2];
algorithm
  for i in 1:size(x, 1) loop
    for j in 1:size(y, 1) loop
      row[j, 1] := y[j];
      row[j, 2] := z[i, j];
    end for;
    column[i, 1] := x[i];
    column[i, 2] := akima(row, v);
  end for;
  w := akima(column, u);
  annotation(Documentation(info = "<html><p>Curves along the second argument in every row, then one along the first through their values: smooth in both, for maps of up to some dozen rows. Source: H. Akima, J. ACM 17 (1970) 589.</p></html>"));
end akima2;
