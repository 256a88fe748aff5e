within Effects.Shapes;
model FrictionOverSpeed "Friction that depends on the speed in a way of its own"
  extends Interfaces.TranslationalShunt;
  parameter SI.Force F_1(min = 0, nominal = 100) = 0 "Friction at rest";
  parameter SI.Force F_2(min = 0, nominal = 100) = 0 "Friction at a sixth of the greatest speed";
  parameter SI.Force F_3(min = 0, nominal = 100) = 0 "Friction at a third of it";
  parameter SI.Force F_4(min = 0, nominal = 100) = 0 "Friction at half of it";
  parameter SI.Force F_5(min = 0, nominal = 100) = 0 "Friction at two thirds of it";
  parameter SI.Force F_6(min = 0, nominal = 100) = 0 "Friction at five sixths of it";
  parameter SI.Force F_7(min = 0, nominal = 100) = 0 "Friction at the greatest speed";
  parameter SI.Velocity v_min(nominal = 0.003) = 0 "Least speed that occurs";
  parameter SI.Velocity v_max(nominal = 0.003) = 1 "Greatest speed that occurs";
  Real g[7] "How near each of seven speeds is";
  parameter SI.Velocity v_c(min = 1e-9) = 0.003 "Speed over which it changes sign";
equation
  for k in 1:7 loop
    g[k] = exp(-((6*(sqrt(v^2 + v_c^2) - v_min)/(v_max - v_min) - (k - 1))/0.8)^2);
  end for;
  f = tanh(v/v_c)*(F_1*g[1] + F_2*g[2] + F_3*g[3] + F_4*g[4] + F_5*g[5] + F_6*g[6] + F_7*g[7]);
  annotation(__bramah(family = "shape", coefficients = {"F_1", "F_2", "F_3", "F_4", "F_5", "F_6", "F_7"}, range = {"v", "v_min", "v_max"}, shapes(v_c = {0.003})));
end FrictionOverSpeed;
