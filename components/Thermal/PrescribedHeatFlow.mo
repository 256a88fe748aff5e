within Thermal;
model PrescribedHeatFlow "Heat flow given by a signal, into what is joined"
  Interfaces.HeatPort port "Port";
  Interfaces.RealInput Q_flow(unit = "W") "Heat flow";
equation
  port.Q_flow = -Q_flow;
end PrescribedHeatFlow;
