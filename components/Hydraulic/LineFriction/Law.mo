within Hydraulic.LineFriction;
partial model Law "Pressure drop of a piece of a line by friction"
  parameter SI.Length L(min = 0) = 1 "Length of the piece";
  parameter SI.Diameter d(min = 1e-4, max = 1, nominal = 1e-2) = 1e-2 "Inner diameter";
  parameter Real added(unit = "1") = 0 "Inertia that the law adds to that of the oil, over it";
  input SI.MassFlowRate m_flow(nominal = 0.1) "Mass flow";
  input SI.Density rho(nominal = 1000) "Density";
  input SI.DynamicViscosity mu(nominal = 0.03) "Dynamic viscosity";
  SI.Pressure dp(nominal = 1e4) "Pressure drop";
  annotation(Documentation(info = "<html><p>Exchanged by <code>redeclare model Friction</code> of <code>Hydraulic.Line</code>.</p></html>"));
end Law;
