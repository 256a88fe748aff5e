within Hydraulic;
model AccumulatorRealGas "Bladder accumulator, real gas (Redlich and Kwong) with a thermal time constant"
  extends Bases.Storage;
  parameter SI.Volume V_0(min = 1e-6, max = 1, nominal = 1e-3, displayUnit = "l") = 1e-3 "Volume of the gas at the precharge";
  parameter SI.Pressure p_pre(min = 1e4, max = 1e8, nominal = 1e6) = 1e7 "Precharge, absolute, at T_wall";
  parameter Real fill(unit = "1", min = 0.05, max = 1) = 0.8 "Volume of the gas at the start over V_0, unless p_start is given";
  parameter SI.Pressure p_start(min = 0, max = 1e8, nominal = 1e6) = 0 "Pressure of the gas at the start; 0: as fill says";
  parameter SI.Pressure p_max(min = 1e4, max = 2e8, nominal = 1e7) = 70e6 "Highest allowed pressure";
  parameter SI.Temperature T_wall(min = 220, max = 420) = 293.15 "Temperature of the wall";
  parameter SI.Time tau(min = 0.01, max = 1e5, nominal = 10) = 10 "Thermal time constant of the gas, 5 to 30 s";
  parameter SI.SpecificHeatCapacity R(min = 50, max = 5000) = 296.8 "Gas constant, nitrogen";
  parameter SI.SpecificHeatCapacity c_v(min = 100, max = 20000) = 743 "Heat capacity of the gas at constant volume, nitrogen";
  parameter SI.Temperature T_c(min = 1, max = 1000) = 126.2 "Critical temperature, nitrogen";
  parameter SI.Pressure p_c(min = 1e4, max = 1e8, nominal = 1e6) = 3.396e6 "Critical pressure, nitrogen";
  parameter Real V_min(unit = "1", min = 0.001, max = 0.5) = 0.02 "Oil left when empty, over V_0";
  parameter Real w_stop(unit = "1", min = 1e-4, max = 0.1) = 0.01 "Volume beyond V_0, over V_0, at which the pressure of the oil reaches zero";
  parameter Real V_full(unit = "1", min = 0.001, max = 0.5) = 0.02 "Gas left when full, over V_0";
  SI.Pressure p(nominal = 1e7) "Pressure of the oil";
  SI.Pressure p_gas(nominal = 1e7) "Pressure of the gas";
  SI.Temperature T(start = T_wall, fixed = true, nominal = 300, stateSelect = StateSelect.prefer) "Temperature of the gas";
  SI.Volume V_gas(start = if p_start > 0 then V_0*min(p_pre/max(p_start, 1), 1) else fill*V_0, nominal = 1e-3, stateSelect = StateSelect.prefer) "Volume of the gas";
  SI.Mass m_gas(nominal = 0.1) "Mass of the gas";
  Real Z(unit = "1") "Compressibility of the gas: p v/(R T)";
protected
  parameter Real a(unit = "Pa.m6/kg2") = 0.42748*R^2*T_c^2/p_c "Attraction at the critical temperature";
  parameter Real b(unit = "m3/kg") = 0.08664*R*T_c/p_c "Volume of the molecules";
  Real v_pre(unit = "m3/kg", start = R*T_wall/p_pre, fixed = false, nominal = 1e-2) "Specific volume at the precharge";
  Real v(unit = "m3/kg", start = R*T_wall/max(p_pre, p_start), fixed = false, nominal = 1e-2) "Specific volume";
  Real p_T(unit = "Pa/K", nominal = 1e4) "Derivative of the gas pressure by temperature";
  Real p_v(unit = "Pa.kg/m3", nominal = 1e9) "Derivative of the gas pressure by specific volume";
  Real p_dot(unit = "Pa/s", nominal = 1e6) "Rate of the oil pressure";
initial equation
  if p_start > 0 then
    p_gas = p_start;
  else
    V_gas = fill*V_0;
  end if;
  p_pre = R*T_wall/(v_pre - b) - a*sqrt(T_c/T_wall)/(v_pre*(v_pre + b));
equation
  assert(V_0 > 0 and p_pre > 0, "V_0 and the precharge p_pre must be positive");
  assert(p_pre < p_max, "The precharge p_pre must lie below p_max");
  assert(p > oil.p_void, "The oil cavitates: more is drawn than flows in, and voids open in the oil. Is the accumulator empty, or too small?", AssertionLevel.warning);
  assert(p < 1.05*p_max, "The pressure exceeds p_max of the accumulator", AssertionLevel.warning);
  assert(p_start <= 0 or p_start >= p_pre, "The pressure at the start p_start must not lie below the precharge p_pre");
  assert(v > 1.05*b, "The gas is compressed beyond the law of Redlich and Kwong");
  der(v_pre) = 0;
  m_gas = V_0/v_pre;
  v = V_gas/m_gas;
  p_gas = R*T/(v - b) - a*sqrt(T_c/T)/(v*(v + b));
  Z = p_gas*v/(R*T);
  p_T = R/(v - b) + a*sqrt(T_c/T)/(2*T*v*(v + b));
  p_v = -R*T/(v - b)^2 + a*sqrt(T_c/T)*(2*v + b)/(v^2*(v + b)^2);
  der(T) = (T_wall - T)/tau - T/(m_gas*c_v)*p_T*der(V_gas);
  p_dot = p_T*der(T) + p_v*der(V_gas)/m_gas
    - 2/(w_stop*V_0)*(p_pre*min(max((V_gas/V_0 - 1)/w_stop, 0), 1) + p_max*min(max((V_full - V_gas/V_0)/w_stop, 0), 1))*der(V_gas);
  p = p_gas + 2*(p_max*Smooth.ramp(V_full - V_gas/V_0, w_stop) - p_pre*Smooth.ramp(V_gas/V_0 - 1, w_stop))/w_stop;
  p = port.p;
  V_oil = V_0*(1 + V_min) - V_gas;
  V_oil/air.beta*p_dot - der(V_gas) = inflow;
  if not oil.thermal then
    Connections.conserved(stored, air.rho_port*port.q, V_gas);
  end if;
  annotation(Documentation(info = "<html>
<p><code>p = R T/(v - b) - a sqrt(T_c/T)/(v (v + b))</code>; balance of energy with Newton's cooling, <code>dT/dt = (T_wall - T)/tau - T/(m c_v) (dp/dT)_v dV/dt</code>. The mass of the gas follows from the precharge. Above some 10 MPa nitrogen takes more volume than an ideal gas: at 30 MPa and 20 degC <code>Z</code> is 1.1 to 1.2.
When empty, the bladder rests on its valve within <code>w_stop V_0</code>; when full, at <code>V_full V_0</code>, it meets a stop that takes <code>p_max</code> within <code>w_stop V_0</code>. Gases of high precharge are beyond the law before that.</p>
<p>Valid up to twice the critical density of the gas. For lower pressures <code>Accumulator</code> is simpler. Source: O. Redlich, J. N. S. Kwong, Chem. Rev. 44 (1949) 233; balance of energy: D. R. Otis and A. Pourmovahed, J. Dyn. Syst. Meas. Control 107 (1985) 116.</p></html>"));
end AccumulatorRealGas;
