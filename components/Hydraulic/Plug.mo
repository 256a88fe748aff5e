within Hydraulic;
model Plug "Closed end of a line"
  Interfaces.HydraulicPort port "Port";
equation
  port.q = 0;
end Plug;
