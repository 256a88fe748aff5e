within Signal.Functions;
function interpolate2 "Bilinear interpolation in a table of two arguments, held at its edges"
  input Real x[:] "First argument, increasing";
  input Real y[:] "Second argument, increasing";
  input Real z[:, :] "Values, rows by x, columns by y";
  input Real u "First argument asked for";
  input Real v "Second argument asked for";
  output Real w "Value";
protected
  Integer i;
  Integer j;
  Real s;
  Real t;
algorithm
  i := 1;
  for k in 2:size(x, 1) - 1 loop
    if u >= x[k] then
      i := k;
    end if;
  end for;
  j := 1;
  for k in 2:size(y, 1) - 1 loop
    if v >= y[k] then
      j := k;
    end if;
  end for;
  s := min(max((u - x[i])/(x[i + 1] - x[i]), 0), 1);
  t := min(max((v - y[j])/(y[j + 1] - y[j]), 0), 1);
  w := (1 - s)*((1 - t)*z[i, j] + t*z[i, j + 1]) + s*((1 - t)*z[i + 1, j] + t*z[i + 1, j + 1]);
  annotation(Documentation(info = "<html><p>Weights are limited to the map: beyond its edges the values of the edge hold.</p></html>"));
end interpolate2;
