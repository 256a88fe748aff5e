within Mechanical.Translational;
model SupportFriction "Dry friction of a slider against the housing, with exact sticking (events)"
  extends Bases.Guide;
  extends Bases.DryFriction;
  parameter Real delta(unit = "1", min = 1, max = 4) = 2 "Exponent of the Stribeck curve: 2 Gauss, 1 Tustin";
  parameter Real peak(unit = "1", min = 1, max = 10) = 1 "Holding force over f_s";
  SI.Acceleration a "Acceleration";
equation
  assert(peak >= 1, "peak must be at least 1");
  a = der(v);
  v_slide = v;
  a_slide = a;
  free = false;
  f_0 = f_s;
  f_hold = peak*f_s;
  f_dry = f_c + (f_s - f_c)*exp(-(noEvent(abs(v))/v_s)^delta);
  f_visc = d*v;
  f = f_fric;
  annotation(Documentation(info = "<html>
<p>The law of <code>Friction</code> between a slider and the housing. Interchangeable with <code>SmoothSupportFriction</code> and <code>LuGreSupportFriction</code>.</p></html>"));
end SupportFriction;
