within Pneumatic.Bases;
partial model Content "Gas in a space: balances of mass and energy"
  Interfaces.HeatPort heatPort "Heat into the gas, at its temperature; left open: no heat through it";
  outer Gas gas "Gas of the circuit";
  parameter SI.ThermalConductance G(min = 0, max = 1e6, nominal = 1) = 0 "Heat transfer to the wall, conductance; 0: adiabatic";
  parameter SI.Temperature T_wall(min = 1, max = 2000, nominal = 300, displayUnit = "degC") = gas.T_0 "Temperature of the wall, for G";
  parameter SI.Pressure p_start(min = 1, max = 1e8, nominal = 1e5, displayUnit = "bar") = gas.p_0 "Pressure at the start";
  parameter SI.Temperature T_start(min = 1, max = 2000, nominal = 300, displayUnit = "degC") = gas.T_0 "Temperature at the start";
  SI.Pressure p(start = p_start, nominal = 1e5, stateSelect = StateSelect.prefer) "Pressure";
  SI.Temperature T(start = T_start, nominal = 300, stateSelect = StateSelect.prefer) "Temperature";
  SI.Volume V_gas(nominal = 1e-3) "Volume of the gas";
  SI.Mass mass(nominal = 1e-3) "Mass of the gas";
  SI.Energy U(nominal = 100) "Internal energy of the gas, from 0 K";
protected
  SI.MassFlowRate m_flow(nominal = 1e-2) "Mass flow into the space";
  SI.EnthalpyFlowRate H_flow(nominal = 1e3) "Flow of enthalpy into the space";
  SI.VolumeFlowRate V_flow(nominal = 1e-3) "Rate of growth of the volume";
equation
  assert(p_start > 0 and T_start > 0, "The pressure p_start and the temperature T_start must be positive");
  assert(G >= 0, "The conductance G must not be negative");
  assert(p > 0, "More gas is drawn from the volume than it holds: its pressure has fallen to zero");
  mass = p*V_gas/(gas.R_s*T);
  U = p*V_gas/(gas.kappa - 1);
  V_gas*der(p) + gas.kappa*p*V_flow = (gas.kappa - 1)*(H_flow + heatPort.Q_flow + G*(T_wall - T));
  V_gas*der(p) + p*V_flow - p*V_gas/T*der(T) = gas.R_s*T*m_flow;
  heatPort.T = T;
  Connections.conserved(mass, m_flow, T);
  Connections.conserved(U, H_flow + heatPort.Q_flow + G*(T_wall - T) - p*V_flow, p);
  annotation(Documentation(info = "<html>
<p>Ideal gas of one pressure and one temperature. Energy, <code>dU/dt = H_flow + Q_flow - p dV/dt</code> with <code>U = p V/(kappa - 1)</code>, <code>V = V_gas</code>, gives
<code>V dp/dt + kappa p dV/dt = (kappa - 1)(H_flow + Q_flow)</code>. Mass, <code>dm/dt = m_flow</code> with <code>m = p V/(R_s T)</code>, gives
<code>V dp/dt + p dV/dt - p V/T dT/dt = R_s T m_flow</code>. Where nothing is joined to <code>heatPort</code> and <code>G = 0</code> the space is adiabatic. A component adds the volume <code>V_gas</code>, its rate, and the flows.</p>
<p>Source: P. Beater, Pneumatic Drives, Springer 2007, chapter on chambers; first law for an open system.</p></html>"));
end Content;
