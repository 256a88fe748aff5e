within Effects;
model HeatRadiation "Heat that radiates to the surroundings"
  extends Interfaces.ThermalShunt;
  parameter Real G(unit = "W/K4", min = 0, nominal = 1e-9) = 0 "Emissivity times area times 5.67e-8 W/(m2.K4)";
  parameter SI.Temperature T_0 = 293.15 "Temperature of the surroundings";
equation
  Q_flow = G*(T^4 - T_0^4);
  annotation(__bramah(family = "heat_exchange", id = "E30", coefficients = {"G"}));
end HeatRadiation;
