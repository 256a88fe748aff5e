within Effects;
model HeatExchange "Gas that warms under compression and relaxes: a capacity that comes late"
  extends Interfaces.HydraulicShunt;
  parameter Real C(unit = "m3/Pa", min = 0, nominal = 3e-14) = 0 "Capacity that comes late, less than the gas has at once";
  parameter SI.Time T_r(min = 1e-6) = 5 "Time constant";
  SI.Pressure x(nominal = 1e6) "Pressure that has relaxed";
initial equation
  x = p;
equation
  T_r*der(x) = p - x;
  q = C*(p - x)/T_r;
  annotation(__bramah(family = "heat_exchange", id = "E28", coefficients = {"C"}, shapes(T_r = {0.5, 3, 20}), part = {"C"}));
end HeatExchange;
