within Hydraulic;
model Tank "Open or pressurised tank of constant pressure"
  Interfaces.HydraulicPort port(dT_outflow = dT) "Port" annotation(__bramah_mixes = true);
  parameter SI.Pressure p(min = 0, nominal = 1e5) = 101325 "Pressure of the tank";
  parameter SI.TemperatureDifference dT(min = -100, max = 150) = 0 "Temperature of its oil above T_0, where oil carries heat";
equation
  port.p = p;
  annotation(Documentation(info = "<html><p>Takes and gives any amount of oil at one pressure. It is what gives a circuit its level of pressure. Level and heating are left out: <code>Reservoir</code>, <code>Thermal.OilMass</code>.</p></html>"));
end Tank;
