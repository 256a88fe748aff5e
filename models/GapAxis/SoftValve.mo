within GapAxis;
partial model SoftValve "Valve that opens from a to b with a linear characteristic, its corner rounded"
  extends Hydraulic.Bases.TwoPort;
  parameter SI.Pressure p_open(min = 0, nominal = 1e6) = 0 "Pressure drop at the corner";
  parameter Real K(unit = "m3/(s.Pa)", min = 0, nominal = 1e-9) = 1e-9 "Conductance when open";
  parameter SI.Pressure w(min = 1, nominal = 1e4) = 2e4 "Width of the corner";
equation
  q = K*Smooth.pos(dp - p_open, w);
  annotation(Documentation(info = "<html><p><code>q = K w ln(1 + exp((dp - p_open)/w))</code>, the law that the comparison prescribes for relief and anticavitation valves. It never closes entirely: with <code>p_open</code> = 0 up to <code>0.28 K w</code> flows against a small pressure drop, so that it is not passive there. Circuits of one's own take <code>Hydraulic.CheckValveLinear</code> and <code>ReliefValveLinear</code>.</p></html>"));
end SoftValve;
