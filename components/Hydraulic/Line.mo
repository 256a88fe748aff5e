within Hydraulic;
model Line "Pipe or hose of n cells: inertia of the oil, laminar and turbulent friction, compliance of oil and wall"
  Interfaces.HydraulicPort port_a "Port a";
  Interfaces.HydraulicPort port_b "Port b";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.Length L(min = 1e-3, max = 1e4, nominal = 1) = 1 "Length";
  parameter SI.Diameter d(min = 1e-4, max = 1, nominal = 1e-2) = 1e-2 "Inner diameter";
  parameter Integer n(min = 1, max = 10000) = 1 "Number of cells; at least f_max L 10/c with c about 1300 m/s";
  parameter SI.BulkModulus beta_wall(min = 1e6, nominal = 1e9) = Modelica.Constants.inf "Modulus of the wall: 0.5 to 1 GPa for hoses, infinite for tubes";
  parameter SI.Length dh = 0 "Height of port b over port a";
  parameter SI.Pressure p_start(nominal = 1e6) = 1e5 "Pressure at the start";
  parameter SI.MassFlowRate m_flow_start(nominal = 0.1) = 0 "Mass flow at the start";
  SI.Pressure p[n](each start = p_start, each fixed = true, each nominal = 1e6) "Pressures of the cells";
  SI.MassFlowRate m_flow[n + 1](each start = m_flow_start, each fixed = true, each nominal = 0.1) "Mass flows between the cells, from a to b";
  SI.Mass mass(nominal = 1) "Mass of the oil";
protected
  constant Real g = Modelica.Constants.g_n;
  parameter SI.Area A = Modelica.Constants.pi*d^2/4 "Cross section";
  parameter SI.Volume V = A*L/n "Volume of a cell";
  parameter Real share[n + 1] = {if i == 1 or i == n + 1 then 0.5/n else 1/n for i in 1:n + 1} "Share of the length between cells";
  SI.Density rho[n](each nominal = 1000) "Densities";
  SI.BulkModulus beta[n](each nominal = 1e9) "Moduli of the oil";
  SI.Volume V_p[n](each nominal = 1e-4) "Volumes of the cells";
  SI.Pressure drop[n + 1](each nominal = 1e4) "Pressure drops by friction";
equation
  assert(L > 0 and d > 0, "Length L and diameter d must be positive");
  for i in 1:n loop
    (rho[i], beta[i]) = oil.density(p[i]);
    V_p[i] = V*(1 + (p[i] - oil.p_0)/beta_wall);
    rho[i]*(V_p[i]/beta[i] + V/beta_wall)*der(p[i]) = m_flow[i] - m_flow[i + 1];
  end for;
  drop[1] = Functions.pipeFriction(m_flow[1], share[1]*L, d, rho[1], oil.mu);
  for i in 2:n + 1 loop
    drop[i] = Functions.pipeFriction(m_flow[i], share[i]*L, d, rho[i - 1], oil.mu);
  end for;
  share[1]*L/A*der(m_flow[1]) = port_a.p - p[1] - drop[1] - share[1]*rho[1]*g*dh;
  for i in 2:n loop
    share[i]*L/A*der(m_flow[i]) = p[i - 1] - p[i] - drop[i] - share[i]*rho[i - 1]*g*dh;
  end for;
  share[n + 1]*L/A*der(m_flow[n + 1]) = p[n] - port_b.p - drop[n + 1] - share[n + 1]*rho[n]*g*dh;
  oil.density(port_a.p)*port_a.q = m_flow[1];
  oil.density(port_b.p)*port_b.q = -m_flow[n + 1];
  mass = rho*V_p;
  annotation(Documentation(info = "<html>
<p>Each cell stores mass, <code>d(rho V)/dt = m_i - m_(i+1)</code>; between cells the oil is accelerated, <code>L/A dm/dt = p_i - p_(i+1) - dp_f - rho g dh</code>; half a cell's length lies at both ends. Both ends carry a flow as state: join them to volumes, or to components with resistance.
Friction is quasi-steady (<code>Functions.pipeFriction</code>), which damps fast waves too little. Source: E. B. Wylie and V. L. Streeter, Fluid Transients in Systems, 1993, chapters 2 and 12.</p></html>"));
end Line;
