within Effects.Shapes;
model ShaftFrictionOverSpeed "Friction that depends on the speed in a way of its own"
  extends Interfaces.RotationalShunt;
  parameter SI.Torque tau_1(min = 0, nominal = 0.1) = 0 "Friction at rest";
  parameter SI.Torque tau_2(min = 0, nominal = 0.1) = 0 "Friction at a sixth of the greatest speed";
  parameter SI.Torque tau_3(min = 0, nominal = 0.1) = 0 "Friction at a third of it";
  parameter SI.Torque tau_4(min = 0, nominal = 0.1) = 0 "Friction at half of it";
  parameter SI.Torque tau_5(min = 0, nominal = 0.1) = 0 "Friction at two thirds of it";
  parameter SI.Torque tau_6(min = 0, nominal = 0.1) = 0 "Friction at five sixths of it";
  parameter SI.Torque tau_7(min = 0, nominal = 0.1) = 0 "Friction at the greatest speed";
  parameter SI.AngularVelocity w_min(nominal = 0.1) = 0 "Least speed that occurs";
  parameter SI.AngularVelocity w_max(nominal = 0.1) = 1 "Greatest speed that occurs";
  Real g[7] "How near each of seven speeds is";
  parameter SI.AngularVelocity w_c(min = 1e-9) = 0.1 "Speed over which it changes sign";
equation
  for k in 1:7 loop
    g[k] = exp(-((6*(sqrt(w^2 + w_c^2) - w_min)/(w_max - w_min) - (k - 1))/0.8)^2);
  end for;
  tau = tanh(w/w_c)*(tau_1*g[1] + tau_2*g[2] + tau_3*g[3] + tau_4*g[4] + tau_5*g[5] + tau_6*g[6] + tau_7*g[7]);
  annotation(__bramah(family = "shape", coefficients = {"tau_1", "tau_2", "tau_3", "tau_4", "tau_5", "tau_6", "tau_7"}, range = {"w", "w_min", "w_max"}, shapes(w_c = {0.1})));
end ShaftFrictionOverSpeed;
