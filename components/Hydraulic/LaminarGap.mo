within Hydraulic;
model LaminarGap "Laminar resistance, conductance given at a viscosity"
  extends Bases.TwoPort;
  parameter Real G(unit = "m3/(s.Pa)", min = 0, max = 1e-6, nominal = 1e-12) = 1e-12 "Conductance at the viscosity mu_G";
  parameter SI.DynamicViscosity mu_G(min = 1e-4, max = 10, nominal = 0.03) = 0.04 "Viscosity at which G holds";
  parameter Boolean followViscosity = true "false: G is taken as it is" annotation(Evaluate = true);
protected
  Real scale(unit = "1") "Conductance over G";
equation
  assert(G >= 0, "The conductance G must not be negative");
  scale = if followViscosity then mu_G/oil.thickening(mu_in, (port_a.p + port_b.p)/2 - oil.p_0) else 1;
  q = G*scale*dp;
  annotation(Documentation(info = "<html><p><code>q = G mu_G/mu dp</code>: Hagen and Poiseuille or a plane gap. The viscosity is that of the mean pressure of the film. Valid below a Reynolds number of
about 2000 in bores. Source: F. M. White, Viscous Fluid Flow, 2nd ed. 1991, chapter 3.</p></html>"));
end LaminarGap;
