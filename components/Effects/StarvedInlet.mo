within Effects;
model StarvedInlet "Delivery falls when the pressure at the first port is low"
  extends Interfaces.HydraulicBridgeAtShaft;
  parameter Real sigma(unit = "m3/rad", nominal = 2e-7) = 0 "Displacement lost at zero pressure";
  parameter SI.Pressure p_c(min = 1) = 1e5 "Pressure below which filling is incomplete";
equation
  q = sigma*w*exp(-Smooth.pos(p_a, 1e4)/p_c);
  annotation(__bramah(family = "cavitation", id = "E33", coefficients = {"sigma"}, shapes(p_c = {5e4, 2e5})));
end StarvedInlet;
