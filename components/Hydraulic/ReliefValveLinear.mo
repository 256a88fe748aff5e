within Hydraulic;
model ReliefValveLinear "Relief valve with a linear characteristic above its setting, from a to b"
  extends Bases.TwoPort;
  parameter SI.Pressure p_set(min = 1e3, max = 1e8, nominal = 1e7) = 200e5 "Pressure drop at which it begins to open";
  parameter Real K(unit = "m3/(s.Pa)", min = 0, max = 1e-5, nominal = 1e-9) = 1e-9 "Conductance when open";
  parameter SI.Pressure w(min = 1, max = 1e6, nominal = 1e4) = 5e4 "Pressure range above p_set in which it opens";
  parameter Real G_leak(unit = "m3/(s.Pa)", min = 0, max = 1e-9, nominal = 1e-16) = 1e-17 "Conductance when closed";
equation
  assert(p_set > 0, "The setting p_set must be positive");
  assert(K >= 0, "The conductance K must not be negative");
  q = K*Smooth.ramp(dp - p_set, w) + G_leak*dp;
  annotation(Documentation(info = "<html><p>The law of <code>CheckValveLinear</code>: closed up to <code>p_set</code> but for <code>G_leak</code>, a parabola over the width <code>w</code>, then the straight line <code>K (dp - p_set - w/2)</code>. The flow never goes against the pressure. Simple stand-in for <code>ReliefValve</code>. Valid near one point of work: override over flow is a straight line.</p></html>"));
end ReliefValveLinear;
