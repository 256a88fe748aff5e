//! stop 0.1
//! z(0) = 0
//! z(0.1) = 0
//! x(0.1) = 0.0497870684
// Currents of three windings without neutral: their zero sequence is 0, so its start value is none that counts.
model M
  parameter Real T[3, 3] = [2/3, -1/3, -1/3; 0, 1/sqrt(3), -1/sqrt(3); 1/3, 1/3, 1/3];
  Real i[3], v[3], vn, x(start = 1, fixed = true), y(start = 0, fixed = true), z(start = 0), w[3];
equation
  for k in 1:3 loop
    v[k] - vn = 0.03*i[k];
  end for;
  sum(i) = 0;
  {x, y, z} = T*i;
  w = T*v;
  w[1] = -1e-3*der(x);
  w[2] = -1e-3*der(y);
  w[3] = -1e-4*der(z);
end M;
