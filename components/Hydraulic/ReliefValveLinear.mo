within Hydraulic;
model ReliefValveLinear "Relief valve with a linear characteristic above its setting, from a to b"
  extends Bases.TwoPort;
  parameter SI.Pressure p_set(min = 1e3, max = 1e8, nominal = 1e7) = 200e5 "Pressure drop at which it opens";
  parameter Real K(unit = "m3/(s.Pa)", min = 0, max = 1e-5, nominal = 1e-9) = 1e-9 "Conductance when open";
  parameter SI.Pressure w(min = 1, max = 1e6, nominal = 1e4) = 5e4 "Width of the opening";
equation
  assert(p_set > 0, "The setting p_set must be positive");
  assert(K >= 0, "The conductance K must not be negative");
  q = K*Smooth.pos(dp - p_set, w);
  annotation(Documentation(info = "<html><p><code>q = K w ln(1 + exp((dp - p_set)/w))</code>. Simple stand-in for <code>ReliefValve</code>.</p></html>"));
end ReliefValveLinear;
