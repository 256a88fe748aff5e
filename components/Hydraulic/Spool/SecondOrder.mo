within Hydraulic.Spool;
block SecondOrder "Lag of second order with limited rate"
  extends Law;
  parameter SI.AngularFrequency w_0(min = 1, max = 1e5, nominal = 100) = 300 "Natural frequency";
  parameter Real D(unit = "1", min = 0.05, max = 5) = 0.8 "Damping";
  parameter Real rate(unit = "1/s", min = 1e-3, max = 1e6) = 100 "Greatest rate of the position";
  Real yd(unit = "1/s", start = 0, fixed = true) "Rate";
initial equation
  y = 0;
equation
  assert(w_0 > 0 and D > 0 and rate > 0, "w_0, D and rate must be positive");
  der(y) = yd;
  der(yd) = 2*D*w_0*(min(max(w_0/(2*D)*(min(max(u, -1), 1) - y), -rate), rate) - yd);
  annotation(Documentation(info = "<html><p>The command of rate, <code>w_0/(2 D)(u - y)</code>, is limited and followed by a lag: within the limit that is <code>y'' + 2 D w_0 y' + w_0^2 y = w_0^2 u</code>. Source: frequency and step responses as data sheets of servo and proportional valves give them.</p></html>"));
end SecondOrder;
