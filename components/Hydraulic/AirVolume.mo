within Hydraulic;
model AirVolume "Volume whose air dissolves and comes out of solution with time"
  Interfaces.HydraulicPort port "Port";
  outer Oil.Fluid oil "Oil of the circuit; its density law must follow the undissolved share x_u";
  parameter SI.Volume V(min = 1e-9, max = 10, nominal = 1e-3, displayUnit = "ml") = 1e-3 "Volume";
  parameter SI.Pressure p_start(nominal = 1e6) = 101325 "Pressure at the start";
  parameter Real x_start(unit = "1", min = 0, max = 1) = oil.x_u "Undissolved share of the air at the start";
  parameter SI.Pressure p_sat(min = 1e5, max = 1e8, nominal = 1e6) = 3e6 "Pressure at which all air is dissolved in equilibrium";
  parameter SI.Time tau_d(min = 1e-3, max = 1e4, nominal = 10) = 10 "Time constant of dissolving, 1 to 60 s";
  parameter SI.Time tau_r(min = 1e-3, max = 1e4, nominal = 1) = 0.5 "Time constant of release";
  SI.Pressure p(start = p_start, fixed = true, nominal = 1e6, stateSelect = StateSelect.prefer) "Pressure";
  Real x(unit = "1", start = x_start, fixed = true) "Undissolved share of the air";
  Real x_eq(unit = "1") "Share in equilibrium";
  SI.Mass mass(nominal = 1) "Mass of the oil";
protected
  constant Real h = 1e-4 "Step of the share for the derivative of the density";
  SI.Density rho(nominal = 1000) "Density";
  SI.BulkModulus beta(nominal = 1e9) "Tangent bulk modulus at constant share";
  Real rho_x(unit = "kg/m3") "Derivative of the density by the share";
  SI.MassFlowRate m_flow(nominal = 0.1) "Mass flow into the volume";
  SI.Time tau "Time constant";
equation
  assert(V > 0, "The volume V must be positive");
  assert(p_sat > oil.p_0, "p_sat must lie above the reference pressure of the oil");
  p = port.p;
  (rho, beta) = oil.density(p, x_u = x);
  rho_x = (oil.density(p, x_u = x + h) - oil.density(p, x_u = x - h))/(2*h);
  m_flow = oil.density(p)*port.q;
  V*(rho/beta*der(p) + rho_x*der(x)) = m_flow;
  x_eq = 1 - Smooth.step((p - oil.p_0)/(p_sat - oil.p_0));
  tau = tau_r + (tau_d - tau_r)*(1 + tanh((x - x_eq)/0.02))/2;
  der(x) = (x_eq - x)/tau + max(m_flow, 0)/(rho*V)*(oil.x_u - x);
  mass = rho*V;
  annotation(Documentation(info = "<html>
<p><code>dx/dt = (x_eq(p) - x)/tau + q_in/V (x_in - x)</code>: bubbles dissolve slowly (<code>tau_d</code>) above saturation and come out faster (<code>tau_r</code>) below; what flows in brings the share of the circuit, <code>oil.x_u</code>.
The oil stiffens while it is held under pressure, and the pressure falls a little. Mass of the oil is conserved.</p>
<p>Source: J. Ruan and R. Burton, IMECE2006-15854; J. Zhou, A. Vacca, B. Manhartsgruber, J. Fluids Eng. 135 (2013) 061101 for the finite rates. The time constants are assumed.</p></html>"));
end AirVolume;
