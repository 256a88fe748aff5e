within Effects;
model EntrainedAir "Free gas at a node: a capacity that falls with the pressure"
  extends Interfaces.HydraulicShunt;
  parameter SI.Volume V_g(min = 0, nominal = 2e-6) = 0 "Volume of the free gas at the pressure p_0";
  parameter Real n(unit = "1", min = 1) = 1.2 "Polytropic exponent";
  parameter SI.Pressure p_0 = 1e5 "Reference pressure";
  SI.Pressure p_s(nominal = 1e6) "Pressure with a floor";
equation
  p_s = 5e3 + Smooth.pos(p - 5e3, 1e3);
  q = V_g*(p_0/p_s)^(1/n)/(n*p_s)*der(p);
  annotation(__bramah(family = "entrained_air", id = "E23", coefficients = {"V_g"}, shapes(n = {1.2})));
end EntrainedAir;
