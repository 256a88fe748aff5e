within Hydraulic;
model BaffledReservoir "Open reservoir with baffles: oil passes n zones from the return to the suction line"
  Interfaces.HydraulicPort port_a(dT_outflow = if oil.thermal then T_oil[1] - oil.T_0 else 0) "Return lines" annotation(__bramah_mixes = true);
  Interfaces.HydraulicPort port_b(dT_outflow = if oil.thermal then T_oil[n] - oil.T_0 else 0) "Suction lines" annotation(__bramah_mixes = true);
  outer Oil.Fluid oil "Oil of the circuit";
  parameter Integer n(min = 2, max = 100) = 3 "Number of zones";
  parameter SI.Area A(min = 1e-6, max = 1e3, nominal = 0.1) = 0.1 "Area of the surface of all zones";
  parameter SI.Height h_max(min = 1e-3, max = 100, nominal = 0.5) = 0.5 "Height of the reservoir";
  parameter SI.Height h_min(min = 0, max = 100) = 0.05 "Level below which lines draw air";
  parameter SI.Height h_start(min = 0, max = 100) = 0.35 "Level at the start";
  parameter SI.Pressure p(min = 1e3, max = 1e7, nominal = 1e5) = 101325 "Pressure above the oil";
  parameter SI.Temperature T_oil_start(min = 220, max = 420) = oil.T_0 "Temperature of the oil at the start, where it carries heat";
  parameter Boolean useHeatPort = false "true: oil that carries heat exchanges it with what is joined to heatPort" annotation(Evaluate = true);
  parameter SI.ThermalConductance kA(min = 0, nominal = 10) = 50 "Heat transfer from the oil of all zones to the wall at heatPort";
  Interfaces.HeatPort heatPort(Q_flow = sum(Q_flow)) if useHeatPort "Heat that the oil takes in through the wall";
  SI.Height h(start = h_start, nominal = 0.1) "Level";
  SI.Temperature T_oil[n](each start = T_oil_start, each fixed = oil.thermal, each nominal = 300) "Temperatures of the zones, from return to suction";
  SI.Time residence(nominal = 100) "Time from return to suction at the present flow";
  SI.Mass mass(nominal = 100) "Mass of the oil";
protected
  SI.Density rho(nominal = 1000) "Density of the oil at the bottom, at T_0";
  SI.MassFlowRate m_a(nominal = 0.1) "Mass flow into the return";
  SI.MassFlowRate m_b(nominal = 0.1) "Mass flow into the suction, negative while a pump draws";
  SI.MassFlowRate m_flow[n - 1](each nominal = 0.1) "Mass flows from zone to zone";
  SI.HeatFlowRate Q_flow[n](each nominal = 10) "Heat through the wall";
  Real growth[n](each unit = "1") "Volumes of the oil over those at T_0";
  Real mean(unit = "1") "Their mean";
equation
  assert(A > 0 and h_max > h_start and h_start > h_min, "The area must be positive, the level at the start between h_min and the height");
  assert(h > h_min, "The reservoir runs dry: its lines draw air");
  assert(h < h_max, "The reservoir overflows");
  rho = oil.density(port_b.p);
  port_a.p = p + rho/mean*Modelica.Constants.g_n*h;
  port_b.p = port_a.p;
  m_a = rho*port_a.q;
  m_b = rho*port_b.q;
  for i in 1:n - 1 loop
    m_flow[i] = m_a - i/n*(m_a + m_b);
  end for;
  if oil.thermal then
    mean = sum(growth)/n;
    for i in 1:n loop
      growth[i] = oil.growth(T_oil[i]);
      Q_flow[i] = if useHeatPort then kA/n*(heatPort.T - T_oil[i]) else 0;
      mass/n*oil.c_p*der(T_oil[i]) = Q_flow[i]
        + (if i > 1 then oil.c_p*max(m_flow[max(i - 1, 1)], 0)*(T_oil[max(i - 1, 1)] - T_oil[i]) else rho*oil.c_p*Connections.inflow(port_a.dT_outflow)*(inStream(port_a.dT_outflow) - port_a.dT_outflow))
        + (if i < n then oil.c_p*max(-m_flow[min(i, n - 1)], 0)*(T_oil[min(i + 1, n)] - T_oil[i]) else rho*oil.c_p*Connections.inflow(port_b.dT_outflow)*(inStream(port_b.dT_outflow) - port_b.dT_outflow));
    end for;
    A*der(h) = mean*(port_a.q + port_b.q) + A*h*oil.gamma/mean*sum(der(T_oil))/n;
  else
    mean = 1;
    growth = fill(1, n);
    Q_flow = fill(0, n);
    T_oil = fill(oil.T, n);
    A*der(h) = port_a.q + port_b.q;
  end if;
  mass = rho/mean*A*h;
  Connections.conserved(mass, m_a + m_b, h);
  residence = mass/max(max(m_a, -m_b), 1e-6*mass);
  annotation(Documentation(info = "<html>
<p>A reservoir of <code>n</code> zones with one level and equal masses. What returns enters the first zone and passes all of them before a pump draws it: each is stirred, so that a change of temperature arrives after the time of residence, the sharper the more zones there are. <code>Reservoir</code> is one zone for all lines.</p>
<p><code>m_i c_p dT_i/dt = m (T_(i-1) - T_i) + kA/n (T_wall - T_i)</code>. Where oil has one temperature for the circuit it is a reservoir with two lines. The work of the weight on oil that moves up and down is left out. Source: O. Levenspiel, Chemical Reaction Engineering, 1999, chapter 14 (tanks in series).</p></html>"));
end BaffledReservoir;
