within Hydraulic.EntrainedAir;
model Dissolving "Air that dissolves and comes out of solution with time: its undissolved share is a state"
  extends Law;
  parameter Real x_start(unit = "1", min = 0, max = 1) = oil.x_u "Undissolved share of the air at the start";
  parameter SI.Pressure p_sat(min = 1e5, max = 1e8, nominal = 1e6) = 3e6 "Pressure at which all air is dissolved in equilibrium";
  parameter SI.Time tau_d(min = 1e-3, max = 1e4, nominal = 10) = 10 "Time constant of dissolving, 1 to 60 s";
  parameter SI.Time tau_r(min = 1e-3, max = 1e4, nominal = 1) = 0.5 "Time constant of release";
  Real share(unit = "1") = x "Undissolved share of the air";
  Real x_eq(unit = "1") "Share in equilibrium";
protected
  constant Real h = 1e-4 "Step of the share for the derivative of the density";
  Real rho_x(unit = "kg/m3", nominal = 10) "Derivative of the density by the share";
  SI.Time tau "Time constant";
initial equation
  x = x_start;
equation
  assert(p_sat > oil.p_0, "p_sat must lie above the reference pressure of the oil");
  (rho, beta,, s) = oil.density(p, x_u = x);
  rho_port = oil.density(p);
  rho_x = (oil.density(p, x_u = x + h) - oil.density(p, x_u = x - h))/(2*h);
  x_eq = 1 - Smooth.step((p - oil.p_0)/(p_sat - oil.p_0));
  tau = tau_r + (tau_d - tau_r)*(1 + tanh((x - x_eq)/0.02))/2;
  der(x) = (x_eq - x)/tau + supply/(rho*V);
  port_density = oil.density(p)/rho;
  swell = -V*rho_x/rho*der(x);
  annotation(Documentation(info = "<html>
<p><code>dx/dt = (x_eq(p) - x)/tau + m_in (x_in - x)/m</code>: bubbles dissolve slowly (<code>tau_d</code>) above saturation and come out faster (<code>tau_r</code>) below. What flows in from a neighbouring cell of a line brings the share there, what comes through a port the share of the circuit, <code>oil.x_u</code>: connectors do not carry it.
The oil stiffens while it is held under pressure, and the pressure falls a little. Mass of the oil is conserved.</p>
<p>The oil's law of density must follow the undissolved share (<code>Oil.Compression.entrainedAir</code>, the default); with another one the share changes and nothing follows.</p>
<p>Source: J. Ruan and R. Burton, IMECE2006-15854; J. Zhou, A. Vacca, B. Manhartsgruber, J. Fluids Eng. 135 (2013) 061101 for the finite rates. The time constants are assumed.</p></html>"));
end Dissolving;
