within Effects;
model PinLeak "Current to ground in proportion to the potential"
  extends Interfaces.ElectricalShunt;
  parameter SI.Conductance G(min = 0, nominal = 1e-3) = 0 "Conductance";
equation
  i = G*v;
  annotation(__bramah(family = "external_leak", id = "E38", coefficients = {"G"}));
end PinLeak;
