within Effects;
model CommandValveDynamics "The command acts through a lag of second order"
  extends Interfaces.Command;
  parameter Real k(unit = "1", min = 0, max = 1, nominal = 1) = 0 "Share, 1 for the whole effect";
  parameter SI.Time T_v(min = 1e-9) = 3e-3 "Time constant";
  parameter Real D(unit = "1", min = 0) = 0.7 "Damping ratio";
  Real x "Value that acts";
  Real z "Its rate over T_v";
initial equation
  x = u;
  z = 0;
equation
  T_v*der(x) = z;
  T_v*der(z) = u - x - 2*D*z;
  y = u - k*(u - x);
  annotation(__bramah(family = "valve_dynamics", id = "E34", coefficients = {"k"}, shapes(T_v = {1e-3, 4e-3, 1.5e-2}, D = {0.7})));
end CommandValveDynamics;
