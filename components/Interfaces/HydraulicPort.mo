within Interfaces;
connector HydraulicPort "Hydraulic port: absolute pressure, volume flow at that pressure, heat that the flow carries"
  SI.Pressure p(start = 1e5, nominal = 1e6) "Absolute pressure";
  flow SI.VolumeFlowRate q(nominal = 1e-4) "Volume flow into the component, counted at the pressure of the port and the temperature T_0 of the oil";
  stream SI.TemperatureDifference dT_outflow(nominal = 10) = 0 "Temperature above T_0 of the oil that leaves the component, where oil carries heat" annotation(HideResult = true);
  annotation(Documentation(info = "<html>
<p>All ports joined in one node have the same pressure and therefore the same density, so that the sum of the volume flows is also the
balance of mass. A component with two ports conserves mass by <code>rho_a*q_a + rho_b*q_b = 0</code>, with the densities <code>oil.density(p)</code>.</p>
<p><b>Heat.</b> Oil declared with <code>thermal = true</code> has a temperature at every place, and what leaves a component says which. All ports of a node have one pressure, so that temperatures mix there as enthalpies do.
A component of your own gives it where it declares the port, <code>Interfaces.HydraulicPort port(dT_outflow = if oil.thermal then T - oil.T_0 else 0)</code>, and takes what comes in from <code>oil.T_0 + inStream(port.dT_outflow)</code>.
One that says nothing lets oil of <code>T_0</code> out. Ports that are joined to parts inside take what those let out. Because flows are counted at <code>T_0</code>, their sum stays the balance of mass; the
volume that passes at the temperature T is <code>q (1 + gamma (T - T_0))</code>.</p>
<p>A port annotated <code>__bramah_mixes</code> belongs to a component that stores oil: what flows through its node passes through the component; of several such components at a node the one declared first is where the flows meet, and the others are dead ends. <code>Connections.inflow(port.dT_outflow)</code> is what comes in, although as much may leave at once.</p></html>"));
end HydraulicPort;
