within Effects.Shapes;
model FrictionOverPosition "Dry friction that depends on the position"
  extends Interfaces.TranslationalShunt;
  parameter SI.Force F_1(min = 0, nominal = 100) = 0 "Friction at one end";
  parameter SI.Force F_2(min = 0, nominal = 100) = 0 "Friction at a sixth of the way";
  parameter SI.Force F_3(min = 0, nominal = 100) = 0 "Friction at a third of the way";
  parameter SI.Force F_4(min = 0, nominal = 100) = 0 "Friction at half of the way";
  parameter SI.Force F_5(min = 0, nominal = 100) = 0 "Friction at two thirds of the way";
  parameter SI.Force F_6(min = 0, nominal = 100) = 0 "Friction at five sixths of the way";
  parameter SI.Force F_7(min = 0, nominal = 100) = 0 "Friction at the other end";
  parameter SI.Position s_min(nominal = 1e-2) = 0 "Least position that occurs";
  parameter SI.Position s_max(nominal = 1e-2) = 1 "Greatest position that occurs";
  Real g[7] "How near each of seven positions is";
  parameter SI.Velocity v_c(min = 1e-9) = 0.003 "Speed over which it changes sign";
equation
  for k in 1:7 loop
    g[k] = exp(-((6*(s - s_min)/(s_max - s_min) - (k - 1))/0.8)^2);
  end for;
  f = tanh(v/v_c)*(F_1*g[1] + F_2*g[2] + F_3*g[3] + F_4*g[4] + F_5*g[5] + F_6*g[6] + F_7*g[7]);
  annotation(__bramah(family = "shape", coefficients = {"F_1", "F_2", "F_3", "F_4", "F_5", "F_6", "F_7"}, range = {"s", "s_min", "s_max"}, shapes(v_c = {0.003})));
end FrictionOverPosition;
