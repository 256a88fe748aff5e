within Interfaces;
connector HeatPort "Heat port"
  SI.Temperature T "Temperature of the port";
  flow SI.HeatFlowRate Q_flow(nominal = 100) "Heat flow into the component";
end HeatPort;
