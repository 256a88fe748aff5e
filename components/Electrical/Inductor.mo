within Electrical;
model Inductor "Inductor"
  extends Bases.OnePort(i(start = i_start));
  parameter SI.Inductance L(min = 1e-9, max = 1e6, nominal = 1e-3) = 1e-3 "Inductance";
  parameter SI.Current i_start = 0 "Current at the start";
equation
  assert(L > 0, "The inductance L must be positive");
  L*der(i) = v;
  annotation(Documentation(info = "<html><p><code>L di/dt = v</code>.</p></html>"));
end Inductor;
