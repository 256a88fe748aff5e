within Electrical;
model Bridge "Converter bridge, averaged over the switching period"
  Interfaces.Pin dc_p "Positive pin of the supply";
  Interfaces.Pin dc_n "Negative pin of the supply";
  Interfaces.Pin p "Positive pin of the load";
  Interfaces.Pin n "Negative pin of the load";
  Interfaces.RealInput u "Modulation, -1 to 1";
  parameter SI.Resistance R_on(min = 0) = 0 "Resistance of the switches in the path";
  SI.Current i "Current of the load";
  Real d "Modulation within its limits";
equation
  d = min(max(u, -1), 1);
  p.v - n.v = d*(dc_p.v - dc_n.v) - R_on*i;
  p.i = -i;
  n.i = i;
  dc_p.i = d*i;
  dc_n.i = -d*i;
  annotation(Documentation(info = "<html><p><code>v = d v_dc</code>, <code>i_dc = d i</code> with the modulation d: the mean over a switching period, without its ripple. Power is conserved but for <code>R_on</code>. Valid for processes slower than the carrier. Source: W. Leonhard, Control of Electrical Drives, 2001.</p></html>"));
end Bridge;
