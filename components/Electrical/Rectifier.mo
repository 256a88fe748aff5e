within Electrical;
model Rectifier "Three-phase diode bridge on the mains, mean over the six pulses"
  Interfaces.Pin p "Positive pin";
  Interfaces.Pin n "Negative pin";
  parameter SI.Voltage U(min = 1e-3, max = 1e6, nominal = 400) = 400 "Voltage from line to line, rms";
  parameter SI.Frequency f(min = 0, max = 1e4, nominal = 50) = 50 "Frequency of the mains";
  parameter SI.Inductance L(min = 0, max = 1, nominal = 1e-4) = 0 "Inductance of a line";
  parameter SI.Resistance R(min = 0, max = 4e5, nominal = 1e-2) = 0 "Resistance of a line";
  parameter SI.Voltage V_knee(min = 0, max = 100) = 0 "Knee voltage of a diode";
  parameter SI.Resistance R_on(min = 1e-9, max = 1e5) = 1e-3 "Resistance of a diode in forward direction";
  parameter SI.Conductance G_off(min = 1e-9, max = 1e3) = 1e-6 "Conductance of the bridge in backward direction";
  parameter Boolean useInput = false "true: scale follows the input, as of a sag" annotation(Evaluate = true);
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the diodes and lines";
  Interfaces.RealInput scale(unit = "1") if useInput "Voltage over U";
  SI.Voltage v(nominal = 500) "Voltage from p to n";
  SI.Current i(nominal = 10) "Current given";
  SI.Voltage v_0(nominal = 500) "Voltage without load";
  SI.Power power(nominal = 1e3) "Power taken from the mains";
  SI.Power lossPower(nominal = 10) "Power lost";
  Diode diode(final R_on = 2*(R_on + R), final G_off = G_off, final V_knee = 2*V_knee) "The two diodes and lines that carry the current";
protected
  Interfaces.RealInput k(unit = "1") "Voltage over U, in use";
  SI.Voltage v_x(nominal = 10) "Voltage lost to commutation";
  SignalVoltage source "Mean of the pulses";
equation
  assert(U > 0 and f >= 0 and L >= 0 and R >= 0, "The voltage U must be positive; f, L and R must not be negative");
  connect(scale, k);
  if not useInput then
    k = 1;
  end if;
  v_0 = 3*sqrt(2)/Modelica.Constants.pi*U*k;
  v_x = 6*f*L*i;
  source.v = v_0 - v_x;
  connect(source.n, n);
  connect(source.p, diode.p);
  connect(diode.n, p);
  v = p.v - n.v;
  i = diode.i;
  power = (v_0 - v_x)*i;
  lossPower = diode.v*diode.i;
  annotation(Documentation(info = "<html><p><code>v = 3 sqrt(2)/pi U - 3/pi 2 pi f L i - 2 (R + R_on) i - 2 V_knee</code>; a reverse current is blocked. While the current goes over from one phase to the next, the line inductance L takes <code>6 f L i</code>, without loss of power. The mean over the six pulses of a period; ripple and the currents of the phases are left out.</p>
<p>Valid for a current that is smooth and does not vanish between pulses, and for an overlap under 60 degrees: <code>i &lt; U/(2 sqrt(2) 2 pi f L)</code>. A link of large capacitance at light load charges to the peak, <code>sqrt(2) U</code>, up to 5 % above; see <code>DiodeBridge</code>.</p>
<p>Source: N. Mohan, T. M. Undeland, W. P. Robbins, Power Electronics, 2003, section 5-6.</p></html>"));
end Rectifier;
