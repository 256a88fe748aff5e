within Effects;
model HeatBridge "Heat from one place to another, past or without a component between them"
  extends Interfaces.ThermalBridge;
  parameter SI.ThermalConductance G(min = 0, nominal = 1) = 0 "Conductance";
equation
  Q_flow = G*(T_a - T_b);
  annotation(__bramah(family = "heat_exchange", id = "E30", coefficients = {"G"}));
end HeatBridge;
