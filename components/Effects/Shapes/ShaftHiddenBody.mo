within Effects.Shapes;
model ShaftHiddenBody "A body on an elastic shaft that nobody sees: a resonance of the load"
  extends Interfaces.RotationalShunt;
  parameter SI.Inertia J(min = 0, nominal = 1e-3) = 0 "Inertia of the body";
  parameter SI.Time T(min = 1e-6) = 0.01 "Period of its resonance over 2 pi";
  parameter Real zeta(unit = "1", min = 0) = 0.1 "Damping ratio";
  SI.Angle z "Angle of the body, at the node at the start";
  SI.AngularVelocity y(nominal = 10, start = 0, fixed = true) "Its speed";
initial equation
  z = phi;
equation
  der(z) = y;
  T^2*der(y) = phi - z + 2*zeta*T*(w - y);
  tau = J*der(y);
  annotation(__bramah(family = "shape", coefficients = {"J"}, shapes(T = {0.003, 0.005, 0.008, 0.012, 0.02, 0.03, 0.05, 0.08})));
end ShaftHiddenBody;
