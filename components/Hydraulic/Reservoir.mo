within Hydraulic;
model Reservoir "Reservoir with a level: open, or closed with a cushion of gas"
  Interfaces.HydraulicPort port(dT_outflow = if oil.thermal then T_oil - oil.T_0 else 0) "Lines below the level, at the bottom" annotation(__bramah_mixes = true);
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.Area A(min = 1e-6, max = 1e3, nominal = 0.1) = 0.1 "Area of the surface";
  parameter SI.Height h_max(min = 1e-3, max = 100, nominal = 0.5) = 0.5 "Height of the reservoir";
  parameter SI.Height h_min(min = 0, max = 100) = 0.05 "Level below which lines draw air";
  parameter SI.Height h_start(min = 0, max = 100) = 0.35 "Level at the start";
  parameter Boolean closed = false "true: closed, with gas above the oil" annotation(Evaluate = true);
  parameter SI.Pressure p_gas(min = 1e3, max = 1e7, nominal = 1e5) = 101325 "Pressure above the oil; closed: at the start";
  parameter Real n_g(unit = "1", min = 1, max = 1.67) = 1.2 "Polytropic exponent of the gas";
  parameter SI.Temperature T_oil_start(min = 220, max = 420) = oil.T_0 "Temperature of the oil at the start, where it carries heat";
  parameter Boolean useHeatPort = false "true: the oil exchanges heat with what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(T = T_oil, Q_flow = Q_flow) if useHeatPort "Heat that the oil takes in";
  SI.Height h(start = h_start, nominal = 0.1) "Level";
  SI.Temperature T_oil(start = T_oil_start, fixed = oil.thermal, nominal = 300) "Temperature of the oil";
  SI.Pressure p(nominal = 1e5) "Pressure above the oil";
  SI.Mass mass(nominal = oil.rho_0*A*h_start) "Mass of the oil";
protected
  SI.Density rho(nominal = 1000) "Density of the oil at the bottom, at T_0";
  SI.BulkModulus beta(nominal = 1e7) "Modulus of the oil there";
  Real yield(unit = "1") "Oil that a rise of the level takes, over that of constant density";
  SI.HeatFlowRate Q_flow(nominal = 10) "Heat through heatPort";
  Real growth(unit = "1") "Volume of the oil over that at T_0";
equation
  assert(A > 0 and h_max > h_start and h_start > h_min, "The area must be positive, the level at the start between h_min and the height");
  assert(h > h_min, "The reservoir runs dry: its lines draw air");
  assert(h < h_max, "The reservoir overflows");
  if closed then
    p = p_gas*((h_max - h_start)/max(h_max - h, 1e-3*h_max))^n_g;
  else
    p = p_gas;
  end if;
  (rho, beta) = oil.density(port.p);
  yield = 1 + h/beta*(rho/growth*Modelica.Constants.g_n + (if closed then n_g*p/max(h_max - h, 1e-3*h_max) else 0));
  if oil.thermal then
    growth = oil.growth(T_oil);
    A*yield*der(h) = growth*port.q + A*h*oil.gamma/growth*der(T_oil);
    mass*oil.c_p*der(T_oil) = rho*oil.c_p*Connections.inflow(port.dT_outflow)*(inStream(port.dT_outflow) - port.dT_outflow) + Q_flow;
  else
    T_oil = oil.T;
    growth = 1;
    A*yield*der(h) = port.q;
  end if;
  if not useHeatPort then
    Q_flow = 0;
  end if;
  port.p = p + rho/growth*Modelica.Constants.g_n*h;
  mass = rho/growth*A*h;
  Connections.conserved(mass, rho*port.q, h);
  annotation(Documentation(info = "<html><p><code>A dh/dt = q</code>, <code>p_port = p + rho g h</code>. Closed, the gas is compressed as the level rises, <code>p (h_max - h)^n = const</code>: what differential cylinders do to a small sealed tank. Oil at the bottom is a little denser than at the top; the density at the bottom counts for all of it. The run ends when the reservoir runs dry or overflows.</p><p>Where the level does not matter: <code>Tank</code>. Source: hydrostatics.</p></html>"));
end Reservoir;
