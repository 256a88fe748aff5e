within Oil.Compression;
function voids "Volume of the voids in oil that is drawn apart, for laws that have none of air"
  input SI.Pressure p "Absolute pressure";
  input SI.Pressure p_v = 0 "Pressure that is not reached however far the oil is drawn apart";
  input SI.Pressure w_v(min = 1) = 1e3 "Fall of the pressure over which voids grow to e times their volume";
  output Real v "Volume over that of the oil at p_0";
  output Real fall "How fast it falls with the pressure, times w_v";
protected
  Real u "Depth below p_v over w_v; -25 where there are no voids";
algorithm
  u := max((p_v - p)/w_v, -25);
  v := max(exp(min(u, 0) + 10)*(1 + max(u, 0)) - exp(-15)*(26 + u), 0);
  fall := max(exp(min(u, 0) + 10) - exp(-15), 0);
  annotation(Inline = true, Documentation(info = "<html><p><code>exp(10 - (p - p_v)/w_v)</code> as in <code>entrainedAir</code>, less its tangent 25 <code>w_v</code> above <code>p_v</code>: from there on, 25 kPa, there are none. As much as the oil at 10 kPa, twenty thousand times as much at <code>p_v</code>, and linear below. Source: regularisation of an empty space.</p></html>"));
end voids;
