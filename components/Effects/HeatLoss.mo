within Effects;
model HeatLoss "Heat to the surroundings"
  extends Interfaces.ThermalShunt;
  parameter SI.ThermalConductance G(min = 0, nominal = 1) = 0 "Conductance";
  parameter SI.Temperature T_0 = 293.15 "Temperature of the surroundings";
equation
  Q_flow = G*(T - T_0);
  annotation(__bramah(family = "heat_exchange", id = "E30", coefficients = {"G"}));
end HeatLoss;
