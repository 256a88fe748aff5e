within Hydraulic;
model AccumulatorPolytropic "Bladder accumulator, polytropic gas"
  extends Bases.Storage(stored(nominal = oil.rho_0*V_0*V_min));
  parameter SI.Volume V_0(min = 1e-6, max = 1, nominal = 1e-3, displayUnit = "l") = 1e-3 "Volume of the gas at the precharge";
  parameter SI.Pressure p_pre(min = 1e4, max = 1e8, nominal = 1e6) = 3e5 "Precharge, absolute";
  parameter SI.Pressure p_start(nominal = 1e6) = 5e5 "Pressure at the start";
  parameter SI.Pressure p_max(min = 1e4, max = 2e8, nominal = 1e7) = 35e6 "Highest allowed pressure";
  parameter Real n(unit = "1", min = 1, max = 2) = 1.2 "Polytropic exponent: 1 slow, 1.2 usual, 1.4 fast";
  parameter Real V_min(unit = "1", min = 0.001, max = 0.5) = 0.02 "Oil left when empty, over V_0";
  parameter Real w_stop(unit = "1", min = 1e-4, max = 0.1) = 0.01 "Rounding of the empty stop, over V_0";
  parameter Real V_full(unit = "1", min = 0.001, max = 0.5) = 0.02 "Gas left when full, over V_0";
  SI.Pressure p(start = p_start, nominal = 1e6, stateSelect = StateSelect.prefer) "Pressure of the oil";
  SI.Volume V_gas(nominal = 1e-3) "Volume of the gas";
protected
  parameter Real w_full(unit = "1") = min(w_stop, V_full/2) "Rounding of the full stop, over V_0";
  Real share(unit = "1") "Part of the change of v that the gas follows: 0 at both stops";
  Real v(unit = "1") "Volume that the gas would take at the pressure of the oil, over V_0";
  SI.Pressure p_s(nominal = 1e6) "Pressure, kept positive";
equation
  assert(V_0 > 0 and p_pre > 0, "V_0 and the precharge p_pre must be positive");
  assert(p_pre < p_max, "The precharge p_pre must lie below p_max");
  assert(p_start >= p_pre, "The accumulator is empty at the start: its precharge p_pre lies above p_start", AssertionLevel.warning);
  assert(p > oil.p_void, "The oil cavitates: more is drawn than flows in, and voids open in the oil. Is the accumulator empty, or too small?", AssertionLevel.warning);
  assert(p < 1.05*p_max, "The pressure exceeds p_max of the accumulator", AssertionLevel.warning);
  p = port.p;
  p_s = max(p, 1e-3*p_pre);
  v = (p_pre/p_s)^(1/n);
  V_gas = V_0*(1 - Smooth.ramp(1 - v + w_stop, 2*w_stop) + Smooth.ramp(V_full - v + w_full, 2*w_full));
  share = min(max((1 - v + w_stop)/(2*w_stop), 0), 1) - min(max((V_full - v + w_full)/(2*w_full), 0), 1);
  V_oil = V_0*(1 + V_min) - V_gas;
  (V_oil/air.beta + V_0*share*v/(n*p_s))*der(p) = inflow;
  annotation(Documentation(info = "<html>
<p><code>p V_gas^n = p_pre V_0^n</code>, with the empty stop, the full stop and the compression of the oil as in <code>Accumulator</code>. The exponent must be chosen for the speed of the process; where both fast strokes and holding occur,
<code>Accumulator</code> finds it by itself. Source: A. Pourmovahed and D. R. Otis, J. Dyn. Syst. Meas. Control 112 (1990) 116, for the time constant that decides between slow and fast.</p></html>"));
end AccumulatorPolytropic;
