within Effects.Interfaces;
partial model HydraulicTransfer "Volume flow from one node to another, wherever they are"
  input SI.Pressure p_a(nominal = 1e6) "Pressure of the first node";
  input SI.Pressure p_b(nominal = 1e6) "Pressure of the second node";
  output SI.VolumeFlowRate q(nominal = 1e-4) "Flow from the first to the second node";
  annotation(__bramah(attach = "Transfer", potential = {"p_a", "p_b"}, through = "q"));
end HydraulicTransfer;
