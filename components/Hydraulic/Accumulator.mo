within Hydraulic;
model Accumulator "Bladder accumulator, gas with a thermal time constant"
  extends Bases.Storage(stored(nominal = oil.rho_0*V_0*V_min));
  parameter SI.Volume V_0(min = 1e-6, max = 1, nominal = 1e-3, displayUnit = "l") = 1e-3 "Volume of the gas at the precharge";
  parameter SI.Pressure p_pre(min = 1e4, max = 1e8, nominal = 1e6) = 3e5 "Precharge, absolute, at T_wall";
  parameter SI.Pressure p_start(nominal = 1e6) = 5e5 "Pressure at the start";
  parameter SI.Pressure p_max(min = 1e4, max = 2e8, nominal = 1e7) = 35e6 "Highest allowed pressure";
  parameter SI.Temperature T_wall(min = 220, max = 420) = 293.15 "Temperature of the wall";
  parameter SI.Temperature T_start(min = 220, max = 420) = T_wall "Temperature of the gas at the start";
  parameter SI.Time tau(min = 0.01, max = 1e5, nominal = 10) = 10 "Thermal time constant of the gas, 5 to 30 s";
  parameter SI.SpecificHeatCapacity R(min = 50, max = 5000) = 296.8 "Gas constant, nitrogen";
  parameter SI.SpecificHeatCapacity c_v(min = 100, max = 20000) = 743 "Heat capacity of the gas at constant volume, nitrogen";
  parameter Real V_min(unit = "1", min = 0.001, max = 0.5) = 0.02 "Oil left when empty, over V_0";
  parameter Real w_stop(unit = "1", min = 1e-4, max = 0.1) = 0.01 "Rounding of the empty stop, over V_0";
  parameter Real V_full(unit = "1", min = 0.001, max = 0.5) = 0.02 "Gas left when full, over V_0";
  SI.Pressure p(start = p_start, nominal = 1e6, stateSelect = StateSelect.prefer) "Pressure of the oil";
  SI.Temperature T(start = T_start, fixed = true, nominal = 300, stateSelect = StateSelect.prefer) "Temperature of the gas";
  SI.Volume V_gas(nominal = 1e-3) "Volume of the gas";
protected
  parameter Real w_full(unit = "1") = min(w_stop, V_full/2) "Rounding of the full stop, over V_0";
  Real share(unit = "1") "Part of the change of V_free that the gas follows: 0 at both stops";
  SI.Volume V_free(nominal = 1e-3) "Volume that the gas would take at the pressure of the oil";
  SI.VolumeFlowRate V_gas_dot(nominal = 1e-4) "Rate of V_gas";
  SI.Pressure p_s(nominal = 1e6) "Pressure, kept positive";
equation
  assert(V_0 > 0 and p_pre > 0, "V_0 and the precharge p_pre must be positive");
  assert(p_pre < p_max, "The precharge p_pre must lie below p_max");
  assert(p_start >= p_pre, "The accumulator is empty at the start: its precharge p_pre lies above p_start", AssertionLevel.warning);
  assert(p > oil.p_void, "The oil cavitates: more is drawn than flows in, and voids open in the oil. Is the accumulator empty, or too small?", AssertionLevel.warning);
  assert(p < 1.05*p_max, "The pressure exceeds p_max of the accumulator", AssertionLevel.warning);
  p = port.p;
  p_s = max(p, 1e-3*p_pre);
  V_free = V_0*(p_pre/p_s)*(T/T_wall);
  V_gas = V_0*(1 - Smooth.ramp(1 - V_free/V_0 + w_stop, 2*w_stop) + Smooth.ramp(V_full - V_free/V_0 + w_full, 2*w_full));
  share = min(max((1 - V_free/V_0 + w_stop)/(2*w_stop), 0), 1) - min(max((V_full - V_free/V_0 + w_full)/(2*w_full), 0), 1);
  V_gas_dot = share*V_free*(der(T)/T - der(p)/p_s);
  der(T) = (T_wall - T)/tau - R*T/(c_v*V_gas)*V_gas_dot;
  V_oil = V_0*(1 + V_min) - V_gas;
  V_oil/air.beta*der(p) - V_gas_dot = inflow;
  annotation(Documentation(info = "<html>
<p>Ideal gas, <code>p V_gas = m R T</code>, and its balance of energy with Newton's cooling, <code>dT/dt = (T_wall - T)/tau - R T/(c_v V_gas) dV_gas/dt</code>: fast strokes are adiabatic (exponent 1.40), slow ones isothermal, and the pressure relaxes
after a fast stroke. Below the precharge the bladder rests on its valve and only the oil in the neck (<code>V_min V_0</code>) is compressed; the passage is rounded within <code>w_stop V_0</code> of it on either side; beyond, the law of the gas holds exactly. Full, the gas keeps <code>V_full V_0</code>, and only the oil is compressed further.</p>
<p>Real gas matters above some 10 MPa; Newton's cooling misses the phase of fast oscillation. Source: D. R. Otis and A. Pourmovahed, J. Dyn. Syst. Meas. Control 107 (1985) 116.</p></html>"));
end Accumulator;
