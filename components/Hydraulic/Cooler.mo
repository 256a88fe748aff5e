within Hydraulic;
model Cooler "Cooler: laminar resistance, and heat passed from the oil to the surroundings"
  extends Bases.TwoPort;
  parameter SI.Pressure dp_nom(min = 1, nominal = 1e4) = 5e4 "Pressure drop at q_nom";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, nominal = 1e-3) = 1e-3 "Flow of dp_nom";
  parameter SI.DynamicViscosity mu_nom(min = 1e-4, max = 10, nominal = 0.03) = 0.04 "Viscosity of the nominal point";
  parameter SI.ThermalConductance kA(min = 0, max = 1e6, nominal = 100) = 300 "Heat transfer to the surroundings";
  parameter SI.Temperature T_ambient(min = 220, max = 420) = 293.15 "Temperature of the surroundings";
  Interfaces.HeatPort oilHeat "Thermal mass of the oil";
equation
  assert(dp_nom > 0 and q_nom > 0 and kA >= 0, "The nominal point must be positive, kA not negative");
  q = q_nom/dp_nom*mu_nom/oil.mu*dp;
  oilHeat.Q_flow = kA*(oilHeat.T - T_ambient);
  annotation(Documentation(info = "<html><p>Laminar pressure drop, <code>q = q_nom dp/dp_nom</code> at the nominal viscosity; heat <code>kA (T_oil - T_ambient)</code> leaves the oil through <code>oilHeat</code>. The temperature of the oil is one for the circuit. Valid while the flow of the coolant does not change; kA is a constant. Source: Newton's law of cooling.</p></html>"));
end Cooler;
