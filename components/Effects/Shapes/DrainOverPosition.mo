within Effects.Shapes;
model DrainOverPosition "Leakage to the low side that depends on the position of a rod"
  extends Interfaces.HydraulicDrainAtRod;
  parameter Real G_1(unit = "m3/(s.Pa)", min = 0, nominal = 3e-12) = 0 "Conductance at one end";
  parameter Real G_2(unit = "m3/(s.Pa)", min = 0, nominal = 3e-12) = 0 "Conductance at a sixth of the way";
  parameter Real G_3(unit = "m3/(s.Pa)", min = 0, nominal = 3e-12) = 0 "Conductance at a third of the way";
  parameter Real G_4(unit = "m3/(s.Pa)", min = 0, nominal = 3e-12) = 0 "Conductance at half of the way";
  parameter Real G_5(unit = "m3/(s.Pa)", min = 0, nominal = 3e-12) = 0 "Conductance at two thirds of the way";
  parameter Real G_6(unit = "m3/(s.Pa)", min = 0, nominal = 3e-12) = 0 "Conductance at five sixths of the way";
  parameter Real G_7(unit = "m3/(s.Pa)", min = 0, nominal = 3e-12) = 0 "Conductance at the other end";
  parameter SI.Position s_min(nominal = 1e-2) = 0 "Least position that occurs";
  parameter SI.Position s_max(nominal = 1e-2) = 1 "Greatest position that occurs";
  Real g[7] "How near each of seven positions is";
equation
  for k in 1:7 loop
    g[k] = exp(-((6*(s - s_min)/(s_max - s_min) - (k - 1))/0.8)^2);
  end for;
  q = (p - p_0)*(G_1*g[1] + G_2*g[2] + G_3*g[3] + G_4*g[4] + G_5*g[5] + G_6*g[6] + G_7*g[7]);
  annotation(__bramah(family = "shape", coefficients = {"G_1", "G_2", "G_3", "G_4", "G_5", "G_6", "G_7"}, range = {"s", "s_min", "s_max"}));
end DrainOverPosition;
