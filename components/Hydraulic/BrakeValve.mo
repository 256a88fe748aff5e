within Hydraulic;
model BrakeValve "Brake valve of a motor: over-centre valves for both directions"
  Interfaces.HydraulicPort port_1 "First line, from the directional valve";
  Interfaces.HydraulicPort port_2 "Second line, from the directional valve";
  Interfaces.HydraulicPort port_A "Motor, first line";
  Interfaces.HydraulicPort port_B "Motor, second line";
  parameter SI.Pressure p_set(min = 1e3, max = 1e8, nominal = 1e7) = 250e5 "Pressure at the motor at which it opens without pilot";
  parameter Real pilotRatio(unit = "1", min = 0, max = 20) = 4 "Area of the pilot over that of the load";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Flow when fully open, at p_set*(1 + override)";
  parameter Real override(unit = "1", min = 0.005, max = 1) = 0.2 "Rise of pressure from cracking to fully open, over p_set";
  parameter SI.Pressure p_crack(min = 100, max = 5e6, nominal = 1e5) = 1e5 "Cracking pressure of the checks to the motor";
  parameter SI.Area A_check(min = 1e-10, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 3e-5 "Cross section of an open check";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-2) = 2e-2 "Time constant of the opening";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  CounterbalanceValve valve_A(p_set = p_set, pilotRatio = pilotRatio, q_nom = q_nom, override = override, p_crack = p_crack, A_check = A_check, tau = tau, A_leak = A_leak, C_d = C_d) "Holds the oil at A, pilot from line 2";
  CounterbalanceValve valve_B(p_set = p_set, pilotRatio = pilotRatio, q_nom = q_nom, override = override, p_crack = p_crack, A_check = A_check, tau = tau, A_leak = A_leak, C_d = C_d) "Holds the oil at B, pilot from line 1";
equation
  connect(port_1, valve_A.port_a);
  connect(valve_A.port_b, port_A);
  connect(port_2, valve_B.port_a);
  connect(valve_B.port_b, port_B);
  connect(valve_A.port_x, port_2);
  connect(valve_B.port_x, port_1);
  annotation(Documentation(info = "<html><p>Two <code>CounterbalanceValve</code>s crosswise: the motor is fed through the check of one line, its return is held back by the valve of the other and let go by the pressure of the feeding line, so that a pulling load cannot outrun the pump. With both lines at tank pressure the motor is held in both directions, up to <code>p_set</code>; a motor leaks, add a parking brake. An overload lets oil out to the line, not to the other side of the motor: where it must not run empty, add crossed <code>ReliefValve</code>s and feed.</p>
<p>Valid as <code>CounterbalanceValve</code>; the pilot takes no oil, and the lag is assumed. Passive. Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1: Hydraulik, 2012.</p></html>"));
end BrakeValve;
