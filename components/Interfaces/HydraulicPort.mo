within Interfaces;
connector HydraulicPort "Hydraulic port: absolute pressure and volume flow at that pressure"
  SI.Pressure p(start = 1e5, nominal = 1e6) "Absolute pressure";
  flow SI.VolumeFlowRate q(nominal = 1e-4) "Volume flow into the component, counted at the pressure of the port";
  annotation(Documentation(info = "<html>
<p>All ports joined in one node have the same pressure and therefore the same density, so that the sum of the volume flows is also the
balance of mass. A component with two ports conserves mass by <code>rho_a*q_a + rho_b*q_b = 0</code>.</p></html>"));
end HydraulicPort;
