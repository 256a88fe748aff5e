within Hydraulic;
model PistonAccumulator "Piston accumulator: gas with thermal time constant, seal friction as a pressure difference"
  Interfaces.HydraulicPort port "Port";
  parameter SI.Volume V_0(min = 1e-6, max = 1, nominal = 1e-3, displayUnit = "l") = 1e-3 "Volume of the gas at the precharge";
  parameter SI.Pressure p_pre(min = 1e4, max = 1e8, nominal = 1e6) = 50e5 "Precharge, absolute, at T_wall";
  parameter SI.Pressure p_start(nominal = 1e6) = 80e5 "Pressure at the start";
  parameter SI.Pressure p_max(min = 1e4, max = 2e8, nominal = 1e7) = 35e6 "Highest allowed pressure";
  parameter SI.Temperature T_wall(min = 220, max = 420) = 293.15 "Temperature of the wall";
  parameter SI.Time tau(min = 0.01, max = 1e5, nominal = 10) = 10 "Thermal time constant of the gas, 5 to 30 s";
  parameter SI.Pressure dp_friction(min = 0, nominal = 1e5) = 1e5 "Pressure difference that moves the piston";
  parameter SI.VolumeFlowRate q_w(min = 1e-9, nominal = 1e-5) = 1e-6 "Flow over which the friction changes sign";
  parameter Real V_full(unit = "1", min = 0.001, max = 0.5) = 0.02 "Gas left when the piston meets the end cover, over V_0";
  DryResistance friction(dp_friction = dp_friction, q_w = q_w) "Seal friction";
  Accumulator gas(V_0 = V_0, p_pre = p_pre, p_start = p_start, p_max = p_max, T_wall = T_wall, tau = tau, V_full = V_full) "Gas and oil";
equation
  connect(port, friction.port_a);
  connect(friction.port_b, gas.port);
  annotation(Documentation(info = "<html><p>The gas of <code>Accumulator</code> behind a piston whose seals hold a pressure difference, <code>dp_friction sign(q)</code>; the mass of the piston is left out. Empty and full it stands at its end covers. Source: D. R. Otis and A. Pourmovahed, J. Dyn. Syst. Meas. Control 107 (1985) 116, for the gas; the friction is assumed constant.</p></html>"));
end PistonAccumulator;
