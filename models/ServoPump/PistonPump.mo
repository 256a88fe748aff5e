within ServoPump;
model PistonPump "The bench's pump, piston by piston: seven chambers, ripple of flow and torque"
  extends PumpPorts;
  parameter SI.Pressure p_start(nominal = 1e6) = 5e5 "Pressure of the chambers at the start";
  Hydraulic.PistonMachine machine(
    z = 7, d = 6.1e-3, H = 4*V/(7*Modelica.Constants.pi*6.1e-3^2), h = 7.5e-6,
    T_c = 0.05, k_p = 0.06, b = 1e-4, p_start = p_start) "Chambers and pistons";
equation
  connect(port_a, machine.port_a);
  connect(port_b, machine.port_b);
  connect(machine.port_case, port_b);
  connect(flange, machine.flange);
  w = machine.w;
  dp = machine.dp;
  Q_A = machine.Q_A;
  T_sh = machine.T_sh;
  annotation(Documentation(info = "<html><p>Takes the place of <code>BenchPump</code>: <code>redeclare ServoPump.PistonPump pump</code>. Bore leakage goes to port B; the shear leakage of the valve plate is not resolved. Seven pistons, their gap and the dead volume are assumed, the paper names none.</p></html>"));
end PistonPump;
