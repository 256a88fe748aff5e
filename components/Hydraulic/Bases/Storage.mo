within Hydraulic.Bases;
partial model Storage "Oil behind one port: balances of mass and heat; the volume is given by who extends it"
  Interfaces.HydraulicPort port(dT_outflow = if oil.thermal then T_oil - oil.T_0 else 0) "Port" annotation(__bramah_mixes = true);
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.Temperature T_oil_start(min = 220, max = 420) = oil.T_0 "Temperature of the oil at the start, where it carries heat";
  parameter Boolean useHeatPort = false "true: the oil exchanges heat with what is joined to heatPort" annotation(Evaluate = true);
  replaceable model Air = EntrainedAir.Frozen constrainedby EntrainedAir.Law "What becomes of the air in the oil";
  Interfaces.HeatPort heatPort(T = T_oil, Q_flow = Q_flow) if useHeatPort "Heat that the oil takes in";
  SI.Temperature T_oil(start = T_oil_start, fixed = oil.thermal, nominal = 300) "Temperature of the oil";
  SI.Volume V_oil(nominal = 1e-3) "Volume of the oil";
  SI.Mass mass(nominal = 1) "Mass of the oil";
  Air air(p = port.p, V = V_oil, supply = noEvent(max(oil.density(port.p)*port.q, 0))*(oil.x_u - air.x)) "Air in the oil";
protected
  SI.VolumeFlowRate inflow(nominal = 1e-4) "Rate at which the oil would grow at constant pressure: what comes in, comes out of solution, and expands";
  SI.HeatFlowRate Q_flow(nominal = 10) "Heat through heatPort";
  Real growth(unit = "1") "Volume of the oil over that at T_0";
  SI.Mass stored(nominal = 1) "What the balance keeps: the mass, but for laws whose modulus does not belong to their density";
equation
  if oil.thermal then
    growth = oil.growth(T_oil);
    inflow = growth*air.port_density*port.q + air.swell + V_oil*oil.gamma/growth*der(T_oil);
    mass*oil.c_p*der(T_oil) = oil.density(port.p)*oil.c_p*Connections.inflow(port.dT_outflow)*(inStream(port.dT_outflow) - port.dT_outflow) + Q_flow + oil.gamma*T_oil/growth*V_oil*der(port.p);
  else
    T_oil = oil.T;
    growth = 1;
    inflow = air.port_density*port.q + air.swell;
    // where it carries heat, a temperature within its tolerance is a pressure far beyond its own: there the pressure is integrated
    Connections.conserved(stored, air.rho_port*port.q, port.p);
  end if;
  if not useHeatPort then
    Q_flow = 0;
  end if;
  mass = air.rho*V_oil/(if oil.thermal then growth else 1);
  stored = air.rho_s*V_oil/(if oil.thermal then growth else 1);
  annotation(Documentation(info = "<html>
<p>A component adds the volume <code>V_oil</code> and <code>V_oil/beta dp/dt + dV/dt = inflow</code>, V being the room for the oil: the balance of mass <code>d(rho V)/dt = m</code>.</p>
<p><b>Heat</b>, where oil carries it: <code>m c_p dT/dt = sum of m_in c_p (T_in - T) + Q + gamma T v_0 m dp/dt</code>, the balance of energy with the enthalpy of <code>Oil.Heat</code>, v_0 being the specific volume at T_0; the last term warms oil that is
compressed, by <code>gamma T dp/(rho c_p)</code>. Elsewhere the oil has the temperature of the circuit, and <code>heatPort</code> gives it.</p>
<p>Source: H. D. Baehr and S. Kabelac, Thermodynamik, Springer 2016, first law for open systems.</p></html>"));
end Storage;
