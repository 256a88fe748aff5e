within Effects;
model PinBridge "Current past a component in proportion to its voltage"
  extends Interfaces.ElectricalBridge;
  parameter SI.Conductance G(min = 0, nominal = 1e-3) = 0 "Conductance";
equation
  i = G*v;
  annotation(__bramah(family = "internal_leak", id = "E19", coefficients = {"G"}, ends = "free"));
end PinBridge;
