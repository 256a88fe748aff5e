within Electrical;
model DiodeBridge "Three-phase bridge of six diodes"
  Interfaces.Pin a "Phase a";
  Interfaces.Pin b "Phase b";
  Interfaces.Pin c "Phase c";
  Interfaces.Pin p "Positive pin";
  Interfaces.Pin n "Negative pin";
  parameter SI.Resistance R_on(min = 1e-9, max = 1e6) = 1e-3 "Resistance of a diode in forward direction";
  parameter SI.Conductance G_off(min = 1e-7, max = 1e3) = 1e-5 "Conductance of a diode in backward direction";
  parameter SI.Voltage V_knee(min = 0, max = 100) = 0 "Knee voltage of a diode";
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the diodes";
  SI.Voltage v(nominal = 500) "Voltage from p to n";
  SI.Current i(nominal = 10) "Current given";
  SI.Power lossPower(nominal = 10) "Power lost";
  Diode upper[3](each final R_on = R_on, each final G_off = G_off, each final V_knee = V_knee) "Diodes to the positive pin";
  Diode lower[3](each final R_on = R_on, each final G_off = G_off, each final V_knee = V_knee) "Diodes from the negative pin";
equation
  connect(a, upper[1].p);
  connect(b, upper[2].p);
  connect(c, upper[3].p);
  connect(a, lower[1].n);
  connect(b, lower[2].n);
  connect(c, lower[3].n);
  for j in 1:3 loop
    connect(upper[j].n, p);
    connect(lower[j].p, n);
  end for;
  v = p.v - n.v;
  i = -p.i;
  lossPower = sum(upper[j].v*upper[j].i + lower[j].v*lower[j].i for j in 1:3);
  annotation(Documentation(info = "<html><p>Each diode switches by an event, 12 in a period of the mains. While the diodes block, the current of a line dies away with the time <code>L G_off</code>; below 1e-7 S that is too short for the integration. Give it lines with inductance, or the current jumps from phase to phase; then join the ground to <code>n</code> and leave the star point of the mains free, since the currents of the three lines add up to 0. For processes slower than the mains: <code>Rectifier</code>, its mean.</p>
<p>Source: N. Mohan, T. M. Undeland, W. P. Robbins, Power Electronics, 2003, section 5-6.</p></html>"));
end DiodeBridge;
