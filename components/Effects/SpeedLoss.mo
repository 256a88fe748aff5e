within Effects;
model SpeedLoss "Delivery lost in proportion to the speed of the shaft"
  extends Interfaces.HydraulicBridgeAtShaft;
  parameter Real sigma(unit = "m3/rad", nominal = 5e-8) = 0 "Displacement lost; positive or negative by the sense of rotation";
equation
  q = sigma*w;
  annotation(__bramah(family = "speed_loss", id = "E21", coefficients = {"sigma"}));
end SpeedLoss;
