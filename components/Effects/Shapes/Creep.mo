within Effects.Shapes;
model Creep "A force that a change of position brings about and that fades"
  extends Interfaces.TranslationalShunt;
  parameter SI.TranslationalSpringConstant c(min = 0, nominal = 1e4) = 0 "Stiffness before it fades";
  parameter SI.Time T(min = 1e-6) = 0.1 "Time in which it fades";
  SI.Position z(nominal = 1e-2) "Position that gives no force, that of the node at the start";
initial equation
  z = s;
equation
  T*der(z) = s - z;
  f = c*(s - z);
  annotation(__bramah(family = "shape", coefficients = {"c"}, shapes(T = {0.03, 0.1, 0.3, 1})));
end Creep;
