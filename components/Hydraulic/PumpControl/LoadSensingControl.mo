within Hydraulic.PumpControl;
model LoadSensingControl "Load sensing: a pressure margin above the highest load, below a pressure cut-off"
  extends Law;
  Interfaces.HydraulicPort port_LS "Pressure of the highest load; takes no flow";
  parameter SI.Pressure dp_LS(min = 1e5, max = 1e7, nominal = 1e6) = 20e5 "Margin above the load at which the pump has swung back";
  parameter SI.Pressure droop_LS(min = 1e4, max = 1e7, nominal = 1e5) = 4e5 "Fall of the margin from there to full displacement";
equation
  assert(dp_LS > droop_LS and droop_LS > 0, "The margin dp_LS must lie above droop_LS, and that above zero");
  u_p = min((p_set - p)/droop, (dp_LS - (port_p.p - port_LS.p))/droop_LS);
  port_LS.q = 0;
  annotation(Documentation(info = "<html><p>The pump delivers what the metering orifice between <code>port_p</code> and <code>port_LS</code> lets through at the margin, so that speed does not depend on load; without flow it idles at the margin. Several consumers: <code>ShuttleValve</code>s find the highest. Source: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001, chapter 9.</p></html>"));
end LoadSensingControl;
