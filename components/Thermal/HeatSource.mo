within Thermal;
model HeatSource "Constant heat flow into what is joined"
  Interfaces.HeatPort port "Port";
  parameter SI.HeatFlowRate Q_flow = 100 "Heat flow";
equation
  port.Q_flow = -Q_flow;
  annotation(Documentation(info = "<html><p>Gives a constant heat flow, positive into what is joined.</p></html>"));
end HeatSource;
