within Thermal;
model PrescribedHeatFlow "Heat flow given by a signal, into what is joined"
  Interfaces.HeatPort port "Port";
  Interfaces.RealInput Q_flow(unit = "W") "Heat flow";
equation
  port.Q_flow = -Q_flow;
  annotation(Documentation(info = "<html><p>Gives the heat flow of the signal, positive into what is joined.</p></html>"));
end PrescribedHeatFlow;
