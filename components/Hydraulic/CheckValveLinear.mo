within Hydraulic;
model CheckValveLinear "Check valve with a linear characteristic: free from a to b"
  extends Bases.TwoPort;
  parameter SI.Pressure p_crack(min = 0, max = 5e6, nominal = 1e5) = 0 "Pressure drop at which it begins to open";
  parameter Real K(unit = "m3/(s.Pa)", min = 0, max = 1e-5, nominal = 1e-9) = 1e-9 "Conductance when open";
  parameter SI.Pressure w(min = 1, max = 1e6, nominal = 1e4) = 2e4 "Pressure range above p_crack in which it opens";
  parameter Real G_leak(unit = "m3/(s.Pa)", min = 0, max = 1e-9, nominal = 1e-16) = 1e-17 "Conductance when closed";
equation
  assert(K >= 0, "The conductance K must not be negative");
  q = K*Smooth.ramp(dp - p_crack, w) + G_leak*dp;
  annotation(Documentation(info = "<html><p>Closed up to <code>p_crack</code> but for <code>G_leak</code>; from there a parabola over the width <code>w</code>, <code>K (dp - p_crack)^2/(2 w)</code>, then the straight line <code>K (dp - p_crack - w/2)</code>. The slope is continuous, and the flow never goes against the pressure. Simple stand-in for <code>CheckValve</code>. Valid near one point of work: the flow of a real valve grows with the root of the pressure drop.</p></html>"));
end CheckValveLinear;
