within Effects.Shapes;
model HeatOverTemperature "Heat loss that depends on the temperature in a way of its own"
  extends Interfaces.ThermalShunt;
  parameter SI.HeatFlowRate Q_1(min = 0, nominal = 1) = 0 "Heat lost at the least temperature";
  parameter SI.HeatFlowRate Q_2(min = 0, nominal = 1) = 0 "Heat lost at a sixth of the range above it";
  parameter SI.HeatFlowRate Q_3(min = 0, nominal = 1) = 0 "Heat lost at a third of the range";
  parameter SI.HeatFlowRate Q_4(min = 0, nominal = 1) = 0 "Heat lost at half of the range";
  parameter SI.HeatFlowRate Q_5(min = 0, nominal = 1) = 0 "Heat lost at two thirds of the range";
  parameter SI.HeatFlowRate Q_6(min = 0, nominal = 1) = 0 "Heat lost at five sixths of the range";
  parameter SI.HeatFlowRate Q_7(min = 0, nominal = 1) = 0 "Heat lost at the greatest temperature";
  parameter SI.Temperature T_min(nominal = 300) = 293.15 "Least temperature that occurs";
  parameter SI.Temperature T_max(nominal = 300) = 294.15 "Greatest temperature that occurs";
  Real g[7] "How near each of seven temperatures is";
equation
  for k in 1:7 loop
    g[k] = exp(-((6*(T - T_min)/(T_max - T_min) - (k - 1))/0.8)^2);
  end for;
  Q_flow = Q_1*g[1] + Q_2*g[2] + Q_3*g[3] + Q_4*g[4] + Q_5*g[5] + Q_6*g[6] + Q_7*g[7];
  annotation(__bramah(family = "shape", coefficients = {"Q_1", "Q_2", "Q_3", "Q_4", "Q_5", "Q_6", "Q_7"}, range = {"T", "T_min", "T_max"}));
end HeatOverTemperature;
