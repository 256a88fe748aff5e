within Electrical;
model Fuse "Fuse: opens for good when the integral of the square of the current passes a limit"
  Interfaces.Pin p "Positive pin";
  Interfaces.Pin n "Negative pin";
  parameter Real I2t(unit = "A2.s", min = 1e-9, max = 1e12, nominal = 100) = 100 "Melting integral: i^2 times time that melts it from cold";
  parameter SI.Time T(min = 1e-6, max = 1e9, nominal = 1) = 1 "Time in which it cools; it bears sqrt(I2t/T) for ever";
  parameter SI.Resistance R_on(min = 1e-9, max = 1e6) = 1e-3 "Resistance";
  parameter SI.Conductance G_off(min = 1e-9, max = 1e3) = 1e-6 "Conductance when blown";
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the losses";
  SI.Voltage v(nominal = 0.1) "Voltage from p to n";
  SI.Current i(nominal = 10) "Current from p to n";
  Real load(unit = "A2.s", start = 0, fixed = true, nominal = 100) "Integral of the square of the current, less what has cooled";
  Boolean blown(start = false, fixed = true) "true: open";
  SI.Power lossPower(nominal = 1) "Power lost";
  Switch element(final R_on = R_on, final G_off = G_off) "Wire of the fuse";
equation
  assert(I2t > 0 and T > 0, "The melting integral I2t and the time T must be positive");
  der(load) = i^2 - load/T;
  blown = pre(blown) or load > I2t;
  element.closed = not blown;
  connect(p, element.p);
  connect(element.n, n);
  v = element.v;
  i = element.i;
  lossPower = v*i;
  annotation(Documentation(info = "<html><p><code>d load/dt = i^2 - load/T</code>; the fuse opens when <code>load</code> passes <code>I2t</code>. For short times no heat leaves the wire and the integral of <code>i^2</code> counts alone; in the long run it bears <code>sqrt(I2t/T)</code>. Choose <code>T</code> by the rated current: <code>I2t/I^2</code>. Opens at once, without an arc: an inductance in the circuit then gives a high voltage over <code>G_off</code>, join a <code>Diode</code> across it.</p>
<p>Source: IEC 60269-1, Low-voltage fuses: time and current characteristics, I2t.</p></html>"));
end Fuse;
