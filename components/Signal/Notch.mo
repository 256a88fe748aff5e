within Signal;
block Notch "Notch filter: takes one frequency out of a signal"
  extends Bases.OneToOne;
  parameter SI.AngularFrequency w(min = 1e-6, max = 1e6, nominal = 100) = 100 "Frequency taken out";
  parameter Real D(unit = "1", min = 1e-3, max = 10) = 0.5 "Half the width of the notch over w";
  parameter Real depth(unit = "1", min = 0, max = 1) = 0 "Gain at w; 0: nothing of it is left";
  parameter Real y_start = 0 "Output at the start";
  SecondOrder lag(final w = w, final D = D, final y_start = y_start) "Lag behind the notch";
equation
  assert(w > 0 and D > 0, "The frequency w and the width D must be positive");
  assert(depth >= 0 and depth <= 1, "The gain depth at w must lie between 0 and 1");
  connect(u, lag.u);
  y = u - 2*D*(1 - depth)/w*lag.yd;
  annotation(Documentation(info = "<html><p><code>(s^2 + 2 depth D w s + w^2)/(s^2 + 2 D w s + w^2)</code>: gain 1 far below and far above w, <code>depth</code> at w. Between the frequencies where the gain has fallen to 0.71 (with <code>depth = 0</code>) lie <code>2 D w</code>. In front of a controller it keeps a resonance of the load out of the loop.</p>
<p>Source: R. C. Dorf and R. H. Bishop, Modern Control Systems, 2011, section 8.5 (notch networks).</p></html>"));
end Notch;
