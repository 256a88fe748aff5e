within Hydraulic;
model HydraulicMotor "Hydraulic motor: oil fed to port_a turns it positively"
  Interfaces.HydraulicPort port_a "Port A: oil fed in here turns the shaft positively";
  Interfaces.HydraulicPort port_b "Port B: oil fed in here turns the shaft negatively";
  Interfaces.RotationalFlange flange "Shaft";
  parameter SI.Volume V(min = 1e-9, max = 1e-2, nominal = 1e-5, displayUnit = "ml") = 1e-5 "Displacement per revolution";
  parameter Boolean useInput = false "true: the displacement follows u, -1 to 1" annotation(Evaluate = true);
  parameter Boolean useHeatPort = false "true: losses heat what is joined to heatPort, and the oil in the gaps has the temperature there" annotation(Evaluate = true);
  Interfaces.RealInput u(unit = "1") if useInput "Displacement over V";
  Interfaces.HeatPort heatPort if useHeatPort "Case: heat of the losses";
  replaceable Pump machine(V = V, useInput = useInput, useHeatPort = useHeatPort) constrainedby Bases.Machine(V = V, useInput = useInput, useHeatPort = useHeatPort) "The machine, its ports crossed";
  SI.AngularVelocity w(nominal = 100) "Speed of the shaft";
  SI.Pressure dp(nominal = 1e6) "Pressure of A above B";
  SI.VolumeFlowRate Q_in(nominal = 1e-4) "Volume flow into port A";
  SI.Torque T_out(nominal = 10) "Torque that the motor gives to the shaft";
  SI.Power power(nominal = 1e3) "Power that the motor gives to the shaft";
  SI.Power lossPower(nominal = 10) "Power lost";
equation
  connect(port_a, machine.port_b);
  connect(port_b, machine.port_a);
  connect(machine.flange, flange);
  connect(u, machine.u);
  connect(heatPort, machine.heatPort);
  w = machine.w;
  dp = port_a.p - port_b.p;
  Q_in = port_a.q;
  T_out = -machine.T_sh;
  power = T_out*w;
  lossPower = machine.lossPower;
  annotation(Documentation(info = "<html><p>The machine is that of pumps (<code>Bases.Machine</code>, by default <code>Pump</code>), which turns positively when oil is fed to its port B; here the ports are crossed and the torque counts as the user of a motor expects: with p_A above p_B it turns positively and <code>T_out = V/(2 pi) dp - T_loss</code>, <code>power = T_out w</code>; the flow that it takes, <code>Q_in = V n + Q_leak</code>. Fed at B it turns negatively; driven by its load it pumps from B to A when turned negatively, from A to B when turned positively.</p>
<p>Leakage and friction are set at <code>machine</code>: <code>HydraulicMotor motor(V = 1e-4, machine(G = 1e-12, k_p = 0.04))</code>; another machine: <code>HydraulicMotor motor(redeclare OrbitMotor machine, V = 2e-4)</code>; whose displacement follows from its geometry (axial or radial pistons) is used by itself. Valid as the machine chosen. Source: as <code>Bases.Machine</code>.</p></html>"));
end HydraulicMotor;
