within Signal.Functions;
function interpolate2 "Bilinear interpolation in a table of two arguments, held at its edges or going on"
  input Real x[:] "First argument, increasing";
  input Real y[:] "Second argument, increasing";
  input Real z[:, :] "Values, rows by x, columns by y";
  input Real u "First argument asked for";
  input Real v "Second argument asked for";
  input Boolean hold = true "true: the values of the edge hold outside, false: the outermost cells go on";
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
  s := (u - x[i])/(x[i + 1] - x[i]);
  t := (v - y[j])/(y[j + 1] - y[j]);
  if hold then
    s := min(max(s, 0), 1);
    t := min(max(t, 0), 1);
  end if;
  w := (1 - s)*((1 - t)*z[i, j] + t*z[i, j + 1]) + s*((1 - t)*z[i + 1, j] + t*z[i + 1, j + 1]);
  annotation(Documentation(info = "<html><p>Where the edges hold, the weights are limited to the map.</p></html>"));
end interpolate2;
