within Hydraulic;
model Line "Pipe or hose of n cells: inertia of the oil, laminar and turbulent friction, compliance of oil and wall"
  Interfaces.HydraulicPort port_a(dT_outflow = if oil.thermal then T_oil[1] - oil.T_0 + (if volume_a then 0 else oil.throttling(p[1]) - oil.throttling(port_a.p)) else 0) "Port a";
  Interfaces.HydraulicPort port_b(dT_outflow = if oil.thermal then T_oil[N] - oil.T_0 + (if volume_b then 0 else oil.throttling(p[N]) - oil.throttling(port_b.p)) else 0) "Port b";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.Length L(min = 1e-3, max = 1e4, nominal = 1) = 1 "Length";
  parameter SI.Diameter d(min = 1e-4, max = 1, nominal = 1e-2) = 1e-2 "Inner diameter";
  parameter Integer n(min = 1, max = 10000) = 1 "Number of cells; at least f_max L 10/c with c about 1300 m/s";
  parameter Boolean volume_a = true "true: half a cell of volume lies at port a; false: half a cell's length, for a source whose pressure jumps" annotation(Evaluate = true);
  parameter Boolean volume_b = true "true: half a cell of volume lies at port b" annotation(Evaluate = true);
  replaceable model Friction = LineFriction.Steady constrainedby LineFriction.Law "Law of friction";
  parameter SI.BulkModulus beta_wall(min = 1e6, nominal = 1e9) = Modelica.Constants.inf "Modulus of the wall: 0.5 to 1 GPa for hoses, infinite for tubes";
  parameter SI.Length dh = 0 "Height of port b over port a";
  parameter SI.Pressure p_start(nominal = 1e6) = 101325 "Pressure at the start, at port a";
  parameter SI.Pressure p_b_start(nominal = 1e6) = p_start "Pressure at the start, at port b";
  parameter SI.MassFlowRate m_flow_start(nominal = 0.1) = 0 "Mass flow at the start";
  parameter SI.Temperature T_oil_start(min = 220, max = 420) = oil.T_0 "Temperature of the oil at the start, where it carries heat";
  parameter Boolean useHeatPort = false "true: oil that carries heat exchanges it with what is joined to heatPort" annotation(Evaluate = true);
  parameter SI.ThermalConductance kA(min = 0, nominal = 10) = 10*Modelica.Constants.pi*d*L "Heat transfer to heatPort over the whole length, 10 W/(m2.K) to still air";
  Interfaces.HeatPort heatPort(Q_flow = sum(Q_flow)) if useHeatPort "Heat that the oil takes in through the wall";
  replaceable model Air = EntrainedAir.Frozen constrainedby EntrainedAir.Law "What becomes of the air in the oil";
  SI.Pressure p[N](start = {p_start + (p_b_start - p_start)*x[i] for i in 1:N}, each nominal = 1e6) "Pressures of the cells";
  SI.MassFlowRate m_flow[M](each start = m_flow_start, each nominal = 0.1) "Mass flows between the cells, from a to b";
  SI.Temperature T_oil[N](each start = T_oil_start, each fixed = oil.thermal, each nominal = 300) "Temperatures of the cells";
  SI.Mass mass(nominal = 1) "Mass of the oil";
  Air air[N](p = p, V = V_p, supply = supply) "Air in the cells";
  Friction friction[M](L = share*L, each d = d) "Friction between the cells";
protected
  constant Real g = Modelica.Constants.g_n;
  constant Real half = 0.5 "Share of oil in a cell below which less than the whole flow leaves it";
  parameter Integer a = if volume_a then 1 else 0 "Cells before the first flow";
  parameter Integer b = if volume_b then 1 else 0 "Cells after the last flow";
  parameter Boolean staggered = volume_a or volume_b "true: flows run over a whole cell's length each, cells lie around their ends";
  parameter Integer M = if staggered then n else n + 1 "Number of flows";
  parameter Integer N = M - 1 + a + b "Number of cells";
  parameter SI.Area A = Modelica.Constants.pi*d^2/4 "Cross section";
  parameter Real x[N] = {if staggered then (i - a)/n else (i - 0.5)/n for i in 1:N} "Places of the cells over the length";
  parameter SI.Volume V[N] = {if volume_a and i == 1 or volume_b and i == N then 0.5*A*L/n else A*L/n for i in 1:N} "Volumes of the cells";
  parameter Real share[M] = {if not staggered and (i == 1 or i == M) then 0.5/n else 1/n for i in 1:M} "Share of the length between cells";
  SI.MassFlowRate m_carried[M](each nominal = 0.1) "Mass flows between the cells: m_flow, less where the cell before is mostly void";
  SI.MassFlowRate m_left[N](each nominal = 0.1) "Mass flows into the cells from the side of a";
  SI.MassFlowRate m_right[N](each nominal = 0.1) "Mass flows out of the cells to the side of b";
  SI.MassFlowRate supply[N](each nominal = 0.1) "What flows into the cells, by the share of its air above the one there";
  SI.Volume V_p[N](each nominal = 1e-4) "Volumes of the cells under pressure";
  SI.Mass stored[N](nominal = oil.rho_0*V) "What the balances keep: the masses";
  Real growth[N](each unit = "1") "Volumes of the oil over those at T_0";
  SI.HeatFlowRate Q_flow[N](each nominal = 10) "Heat that the cells take in through the wall";
  SI.Temperature T_low[N](each nominal = 300) "Temperatures that the oil of the cells has when throttled to the reference pressure";
  SI.Temperature T_m[M](each nominal = 300) "Temperatures between the cells: of the cell from which the oil comes";
  SI.Density rho_m[M](each nominal = 1000) "Densities between the cells: that of the cell before, at the first that of the cell after";
  SI.MassFlowRate m_a(nominal = 0.1) "Mass flow into port a";
  SI.MassFlowRate m_b(nominal = 0.1) "Mass flow out of port b";
equation
  assert(L > 0 and d > 0, "Length L and diameter d must be positive");
  assert(N > 0, "A line with volume at one end only needs two cells");
  oil.density(port_a.p)*port_a.q = m_a;
  oil.density(port_b.p)*port_b.q = -m_b;
  if volume_a then
    port_a.p = p[1];
  else
    m_a = m_carried[1];
  end if;
  if volume_b then
    port_b.p = p[N];
  else
    m_b = m_carried[M];
  end if;
  for i in 1:N loop
    V_p[i] = V[i]*(1 + (p[i] - oil.p_0)/beta_wall);
    m_left[i] = if i - a < 1 then m_a else m_carried[max(i - a, 1)];
    m_right[i] = if i - a + 1 > M then m_b else m_carried[min(i - a + 1, M)];
    supply[i] = noEvent(max(m_left[i], 0))*((if i > 1 then air[max(i - 1, 1)].x else oil.x_u) - air[i].x)
      + noEvent(max(-m_right[i], 0))*((if i < N then air[min(i + 1, N)].x else oil.x_u) - air[i].x);
    if oil.thermal then
      growth[i] = oil.growth(T_oil[i]);
      T_low[i] = T_oil[i] + oil.throttling(p[i]);
      Q_flow[i] = if useHeatPort then kA*V[i]/sum(V)*(heatPort.T - T_oil[i]) else 0;
      air[i].rho*V_p[i]/growth[i]*oil.c_p*der(T_oil[i]) = oil.c_p*max(m_left[i], 0)*((if i > 1 then T_low[max(i - 1, 1)] else oil.T_0 + inStream(port_a.dT_outflow) + oil.throttling(port_a.p)) - T_low[i])
        + oil.c_p*max(-m_right[i], 0)*((if i < N then T_low[min(i + 1, N)] else oil.T_0 + inStream(port_b.dT_outflow) + oil.throttling(port_b.p)) - T_low[i]) + Q_flow[i] + oil.gamma*T_oil[i]/growth[i]*V_p[i]*der(p[i]);
      air[i].rho*(V_p[i]/air[i].beta + V[i]/beta_wall)*der(p[i]) = growth[i]*(m_left[i] - m_right[i]) + air[i].rho*(air[i].swell + V_p[i]*oil.gamma/growth[i]*der(T_oil[i]));
    else
      growth[i] = 1;
      T_low[i] = oil.T;
      Q_flow[i] = 0;
      T_oil[i] = oil.T;
      air[i].rho*(V_p[i]/air[i].beta + V[i]/beta_wall)*der(p[i]) = m_left[i] - m_right[i] + air[i].rho*air[i].swell;
    end if;
  end for;
  for i in 1:N loop
    stored[i] = air[i].rho_s*V_p[i]/growth[i];
    if not oil.thermal then
      Connections.conserved(stored[i], (if volume_a and i == 1 then air[1].rho_port*port_a.q else air[i].counted*m_left[i]) + (if volume_b and i == N then air[N].rho_port*port_b.q else -air[i].counted*m_right[i]), p[i]);
    end if;
  end for;
  for i in 1:M loop
    m_carried[i] = noEvent(max(m_flow[i], 0))*(if i - 1 + a < 1 then 1 else noEvent(min(air[max(i - 1 + a, 1)].rho/(half*oil.rho_l), 1)))
      + noEvent(min(m_flow[i], 0))*(if i + a > N then 1 else noEvent(min(air[min(i + a, N)].rho/(half*oil.rho_l), 1)));
    rho_m[i] = air[max(i - 1 + a, 1)].rho/growth[max(i - 1 + a, 1)];
    T_m[i] = if not oil.thermal then oil.T else Smooth.blend(m_flow[i], 1e-3*A,
      if i - 1 + a < 1 then oil.T_0 + inStream(port_a.dT_outflow) else T_oil[max(i - 1 + a, 1)],
      if i + a > N then oil.T_0 + inStream(port_b.dT_outflow) else T_oil[min(i + a, N)]);
    friction[i].m_flow = m_flow[i];
    friction[i].rho = rho_m[i];
    friction[i].mu = if oil.thermal then oil.viscosity(T_m[i]) else oil.mu;
    share[i]*L/A*(1 + friction[i].added)*der(m_flow[i]) =
      (if i - 1 + a < 1 then port_a.p else p[max(i - 1 + a, 1)]) - (if i + a > N then port_b.p else p[min(i + a, N)])
      - friction[i].dp - share[i]*rho_m[i]*g*dh;
  end for;
  mass = sum(air[i].rho*V_p[i]/growth[i] for i in 1:N);
  annotation(Documentation(info = "<html>
<p>Each cell stores mass, <code>d(rho V)/dt = m_i - m_(i+1)</code>; between cells the oil is accelerated, <code>L/A dm/dt = p_i - p_(i+1) - dp_f - rho g dh</code>. Half a cell lies at each port, whose pressure is that of the cell: anything may be joined there, a pump, a valve that closes, another line, a volume, or nothing.
What cannot be joined is a pressure that jumps, since the oil of half a cell cannot grow in no time: with <code>volume_a = false</code> or <code>volume_b = false</code> half a cell's length lies at that end instead, whose flow is a state; join it to a source of pressure, a volume, or a component with resistance that never shuts.</p>
<p>Where a column of oil tears off, voids grow in a cell; once they fill more than half of it, what flows on carries less, in proportion to the oil that is left, so that a line may run empty but not below.</p>
<p>With laminar friction the line tends to the solution by characteristics with second order in the number of cells: a wave as long as the line comes out to 2 % with 20 cells, to 0.1 % with 80. Steeper fronts ring behind them, with a wave length of two cells. Friction is quasi-steady, which damps fast waves too little; <code>redeclare model Friction = LineFriction.Unsteady</code> weights the past of the flow. Valid for flows far below the speed of sound.</p>
<p>The air in the oil is frozen; with <code>redeclare model Air = EntrainedAir.Dissolving</code> each cell has a share of its own that dissolves, comes out of solution, and is carried along with the flow.</p>
<p>Source: E. B. Wylie and V. L. Streeter, Fluid Transients in Systems, 1993, chapters 2 and 12.</p></html>"));
end Line;
