//! E024 at 5: "this is a class"
model M
  Real x;
equation
  x = 2*Modelica.Constants;
end M;
