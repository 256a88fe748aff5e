//! E210 at 18: "counts by an enumeration `M.Color`, and the index is an Integer"
//! E210 at 18: "counts by an Integer, and the index is an enumeration `M.Color`"
//! E210 at 19: "counts by a Boolean, and the index is an Integer"
//! E210 at 20: "give a literal, as in `[M.Color.red]`"
model M
  type Color = enumeration(red, green, blue);
  function second
    input Real w[Color];
    output Real y;
  algorithm
    y := w[Color.green];
  end second;
  Real w[Color] = {1, 2, 3};
  Real v[3] = {1, 2, 3};
  Real z[Boolean] = {1, 2};
  Real y[3];
equation
  y[1] = w[2] + v[Color.red] + second(w);
  y[2] = z[1] + z[true];
  y[3] = sum(w[i] for i in 1:3);
end M;
