within Hydraulic;
model CheckValveLinear "Check valve with a linear characteristic: free from a to b"
  extends Bases.TwoPort;
  parameter SI.Pressure p_crack(min = 0, max = 5e6, nominal = 1e5) = 0 "Pressure drop at which it opens";
  parameter Real K(unit = "m3/(s.Pa)", min = 0, max = 1e-5, nominal = 1e-9) = 1e-9 "Conductance when open";
  parameter SI.Pressure w(min = 1, max = 1e6, nominal = 1e4) = 2e4 "Width of the opening";
equation
  assert(K >= 0, "The conductance K must not be negative");
  q = K*Smooth.pos(dp - p_crack, w);
  annotation(Documentation(info = "<html><p><code>q = K w ln(1 + exp((dp - p_crack)/w))</code>. It never closes entirely; around dp = 0 a flow of at most <code>0.28 K w</code> goes against the pressure, so that it is passive only beyond that width. Simple
stand-in for <code>CheckValve</code>.</p></html>"));
end CheckValveLinear;
