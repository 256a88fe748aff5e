within Electrical;
model Capacitor "Capacitor"
  extends Bases.OnePort(v(start = v_start));
  parameter SI.Capacitance C(min = 1e-12, max = 1e6, nominal = 1e-6) = 1e-6 "Capacitance";
  parameter SI.Voltage v_start = 0 "Voltage at the start";
equation
  assert(C > 0, "The capacitance C must be positive");
  C*der(v) = i;
  annotation(Documentation(info = "<html><p><code>C dv/dt = i</code>.</p></html>"));
end Capacitor;
