within Signal.Functions;
function akima "Akima's interpolation in a table of two columns: smooth, without overshoot at steps"
  input Real table[:, 2] "Abscissa, ordinate; at least two rows, abscissae strictly increasing";
  input Real u "Abscissa asked for";
  output Real y "Ordinate; straight beyond the ends";
protected
  Integer n = size(table, 1);
  Integer i;
  Real m[5] "Slopes of the segments around, i-2 to i+2";
  Real h;
  Real s;
  Real a;
  Real b;
  Real t_1;
  Real t_2;
algorithm
  i := 1;
  for k in 2:n - 1 loop
    if u >= table[k, 1] then
      i := k;
    end if;
  end for;
  m[3] := (table[i + 1, 2] - table[i, 2])/(table[i + 1, 1] - table[i, 1]);
  m[4] := if i + 2 <= n then (table[min(i + 2, n), 2] - table[i + 1, 2])/max(table[min(i + 2, n), 1] - table[i + 1, 1], 1e-300) else m[3];
  m[2] := if i >= 2 then (table[i, 2] - table[max(i - 1, 1), 2])/max(table[i, 1] - table[max(i - 1, 1), 1], 1e-300) else 2*m[3] - m[4];
  m[4] := if i + 2 <= n then m[4] else 2*m[3] - m[2];
  m[5] := if i + 3 <= n then (table[min(i + 3, n), 2] - table[min(i + 2, n), 2])/max(table[min(i + 3, n), 1] - table[min(i + 2, n), 1], 1e-300) else 2*m[4] - m[3];
  m[1] := if i >= 3 then (table[max(i - 1, 1), 2] - table[max(i - 2, 1), 2])/max(table[max(i - 1, 1), 1] - table[max(i - 2, 1), 1], 1e-300) else 2*m[2] - m[3];
  a := abs(m[4] - m[3]);
  b := abs(m[2] - m[1]);
  t_1 := if a + b > 1e-300 then (a*m[2] + b*m[3])/(a + b) else (m[2] + m[3])/2;
  a := abs(m[5] - m[4]);
  b := abs(m[3] - m[2]);
  t_2 := if a + b > 1e-300 then (a*m[3] + b*m[4])/(a + b) else (m[3] + m[4])/2;
  h := table[i + 1, 1] - table[i, 1];
  s := u - table[i, 1];
  if s < 0 then
    y := table[i, 2] + t_1*s;
  elseif s > h then
    y := table[i + 1, 2] + t_2*(s - h);
  else
    y := table[i, 2] + s*(t_1 + s/h*(3*m[3] - 2*t_1 - t_2 + s/h*(t_1 + t_2 - 2*m[3])));
  end if;
  annotation(Documentation(info = "<html><p>Source: H. Akima, J. ACM 17 (1970) 589.</p></html>"));
end akima;
