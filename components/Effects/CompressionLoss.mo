within Effects;
model CompressionLoss "Delivery lost in proportion to speed and pressure"
  extends Interfaces.HydraulicBridgeAtShaft;
  parameter Real c(unit = "m3/(rad.Pa)", min = 0, nominal = 2e-15) = 0 "Displacement lost per pascal";
  parameter SI.AngularVelocity w_s(min = 1e-6) = 1 "Width of the corner";
equation
  q = c*Smooth.mag(w, w_s)*dp;
  annotation(__bramah(family = "compression_loss", id = "E24", coefficients = {"c"}));
end CompressionLoss;
