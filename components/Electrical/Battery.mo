within Electrical;
model Battery "Battery: open-circuit voltage over state of charge, inner resistance and one or two RC pairs"
  extends Bases.OnePort;
  parameter SI.ElectricCharge Q(displayUnit = "A.h", min = 1, max = 1e9, nominal = 1e5) = 72000 "Capacity; 72000 C are 20 A.h";
  parameter Real ocv[:, 2] = [0, 3.0; 0.05, 3.35; 0.1, 3.45; 0.3, 3.6; 0.5, 3.68; 0.7, 3.85; 0.9, 4.05; 1, 4.18] "State of charge, open-circuit voltage of a cell in V; states strictly increasing";
  parameter Integer cells(min = 1, max = 10000) = 1 "Cells in series";
  parameter SI.Resistance R_0(min = 1e-9, max = 1e6, nominal = 1e-2) = 2e-3 "Resistance that acts at once";
  parameter SI.Resistance R_1(min = 1e-9, max = 1e6, nominal = 1e-2) = 1e-3 "Resistance of the first RC pair";
  parameter SI.Time T_1(min = 1e-6, max = 1e9, nominal = 10) = 10 "Time constant R C of the first pair";
  parameter Boolean twoPairs = false "true: with a second RC pair" annotation(Evaluate = true);
  parameter SI.Resistance R_2(min = 1e-9, max = 1e6, nominal = 1e-2) = 1e-3 "Resistance of the second RC pair";
  parameter SI.Time T_2(min = 1e-6, max = 1e9, nominal = 100) = 200 "Time constant R C of the second pair";
  parameter Real soc_start(unit = "1", min = 0, max = 1) = 0.8 "State of charge at the start";
  parameter Real soc_min(unit = "1", min = 0, max = 1) = 0 "Least state of charge allowed";
  parameter Real soc_max(unit = "1", min = 0, max = 1) = 1 "Greatest state of charge allowed";
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the losses";
  Real soc(unit = "1", start = soc_start, fixed = true, nominal = 1) "State of charge";
  SI.Voltage v_oc(nominal = 4) "Open-circuit voltage";
  SI.Voltage v_1(start = 0, fixed = true, nominal = 0.1) "Voltage of the first RC pair";
  SI.Voltage v_2(nominal = 0.1) "Voltage of the second RC pair";
  SI.Power lossPower(nominal = 10) "Power lost";
initial equation
  if twoPairs then
    v_2 = 0;
  end if;
equation
  assert(Q > 0 and R_0 > 0 and R_1 > 0 and T_1 > 0 and R_2 > 0 and T_2 > 0, "Capacity, resistances and time constants of the battery must be positive");
  assert(size(ocv, 1) > 1, "The table of the open-circuit voltage needs at least two rows");
  for j in 2:size(ocv, 1) loop
    assert(ocv[j, 1] > ocv[j - 1, 1], "The states of charge in the table of the open-circuit voltage must increase");
  end for;
  assert(soc_max > soc_min, "soc_max must lie above soc_min");
  assert(soc >= soc_min, "The battery is empty: its state of charge has fallen to soc_min");
  assert(soc <= soc_max, "The battery is full: its state of charge has risen to soc_max");
  der(soc) = i/Q;
  v_oc = cells*Signal.Functions.interpolate(ocv, soc);
  der(v_1) = (R_1*i - v_1)/T_1;
  if twoPairs then
    der(v_2) = (R_2*i - v_2)/T_2;
  else
    v_2 = 0;
  end if;
  v = v_oc + R_0*i + v_1 + v_2;
  lossPower = R_0*i^2 + v_1^2/R_1 + v_2^2/R_2;
  annotation(Documentation(info = "<html><p><code>v = v_oc(soc) + R_0 i + v_1 + v_2</code>, <code>dsoc/dt = i/Q</code>, <code>T_j dv_j/dt = R_j i - v_j</code>; the current i counts positive where it charges. The table is of one cell, the resistances are of the whole battery. Between its rows the voltage is a straight line, outside the ends hold. Leaving the range from <code>soc_min</code> to <code>soc_max</code> stops the run with an error. Starts rested.</p>
<p>Left out: what depends on temperature, ageing, self discharge, hysteresis of the voltage, losses of charge. Valid for currents at which the resistances were measured.</p>
<p>Source: G. L. Plett, Battery Management Systems, volume I, 2015, chapter 2 (equivalent circuits).</p></html>"));
end Battery;
