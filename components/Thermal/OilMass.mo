within Thermal;
model OilMass "Heat storage of the oil of a circuit with its tank, cooled by the surroundings; gives the temperature to the oil"
  Interfaces.HeatPort port "Heat of losses and coolers";
  Interfaces.RealOutput T(unit = "K") "Temperature, for Oil.Fluid.T_in";
  parameter SI.HeatCapacity C(min = 1, max = 1e9, nominal = 1e4) = 15e3 "Heat capacity of oil and metal";
  parameter SI.ThermalConductance G(min = 0, max = 1e6, nominal = 10) = 12.5 "Heat transfer to the surroundings";
  parameter SI.Temperature T_ambient(min = 220, max = 420) = 293.15 "Temperature of the surroundings";
  parameter SI.Temperature T_start(min = 220, max = 420) = T_ambient "Temperature at the start";
  SI.Temperature T_oil(start = T_start, nominal = 300) "Temperature of the oil";
equation
  assert(C > 0 and G >= 0, "The heat capacity C must be positive, G not negative");
  C*der(T_oil) = port.Q_flow - G*(T_oil - T_ambient);
  port.T = T_oil;
  T = T_oil;
  annotation(Documentation(info = "<html><p>Declare the oil with <code>useTemperatureInput = true</code>, join <code>T</code> to its <code>T_in</code> and the heat ports of machines and valves to <code>port</code>. The defaults are a bench of some 5 l with a time constant of 20 min.</p></html>"));
end OilMass;
