within Effects;
model Cavitation "Vapour fills a node below some pressure"
  extends Interfaces.HydraulicShunt;
  parameter Real K(unit = "m3/(s.Pa)", min = 0, nominal = 1e-9) = 0 "Conductance";
  parameter SI.Pressure p_v(nominal = 1e5) = 1e4 "Pressure at which it begins";
  parameter SI.Pressure w(min = 1) = 5e3 "Width of the corner";
equation
  q = -K*Smooth.pos(p_v - p, w);
  annotation(__bramah(family = "cavitation", id = "E33", coefficients = {"K"}, shapes(p_v = {1e4, 8e4})));
end Cavitation;
