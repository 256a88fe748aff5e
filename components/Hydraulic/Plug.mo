within Hydraulic;
model Plug "Closed end of a line"
  Interfaces.HydraulicPort port "Port";
equation
  port.q = 0;
  annotation(Documentation(info = "<html><p>No flow: closes a port that is not used.</p></html>"));
end Plug;
