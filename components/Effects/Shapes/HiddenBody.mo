within Effects.Shapes;
model HiddenBody "A body on a spring that nobody sees: a resonance of the load"
  extends Interfaces.TranslationalShunt;
  parameter SI.Mass m(min = 0, nominal = 5) = 0 "Mass of the body";
  parameter SI.Time T(min = 1e-6) = 0.01 "Period of its resonance over 2 pi";
  parameter Real zeta(unit = "1", min = 0) = 0.1 "Damping ratio";
  SI.Position z(nominal = 1e-2) "Position of the body, at the node at the start";
  SI.Velocity w(nominal = 1e-1, start = 0, fixed = true) "Its speed";
initial equation
  z = s;
equation
  der(z) = w;
  T^2*der(w) = s - z + 2*zeta*T*(v - w);
  f = m*der(w);
  annotation(__bramah(family = "shape", coefficients = {"m"}, shapes(T = {0.003, 0.005, 0.008, 0.012, 0.02, 0.03, 0.05, 0.08})));
end HiddenBody;
