within Hydraulic;
model PipeResistance "Short pipe as a resistance: laminar and turbulent friction, no inertia"
  extends Bases.TwoPort;
  parameter SI.Length L(min = 1e-3, max = 1e4, nominal = 1) = 1 "Length";
  parameter SI.Diameter d(min = 1e-4, max = 1, nominal = 1e-2) = 1e-2 "Inner diameter";
equation
  assert(L > 0 and d > 0, "Length L and diameter d must be positive");
  dp = Functions.pipeFriction(m_flow, L, d, rho, mu_in);
  annotation(Documentation(info = "<html><p>Laminar (Hagen and Poiseuille) below Reynolds number 2000, turbulent (Blasius) above, blended by <code>Functions.pipeFriction</code>; no storage, no inertia: see <code>Line</code>. Smooth pipes up to Re 1e5. Source: H. Schlichting, Boundary-Layer Theory, chapter 20.</p></html>"));
end PipeResistance;
