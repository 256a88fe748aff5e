within Pneumatic;
connector PneumaticPort "Pneumatic port: absolute pressure, mass flow, and the enthalpy that a flow carries"
  SI.Pressure p(start = 1e5, nominal = 1e5) "Absolute pressure";
  flow SI.MassFlowRate m_flow(nominal = 1e-2) "Mass flow into the component";
  stream SI.SpecificEnthalpy h_outflow(nominal = 3e5) "Specific enthalpy of gas that leaves the component" annotation(HideResult = true);
  annotation(Documentation(info = "<html>
<p>All ports joined in one node have the same pressure; the mass flows sum to zero, and so do the flows of enthalpy: what arrives at the node is mixed
without storage. The enthalpy counts from 0 K, <code>h = c_p T</code>. Kinetic energy is left out.</p></html>"));
end PneumaticPort;
