within Mechanical.Rotational;
model BearingFriction "Dry friction of a shaft against the housing, with exact sticking (events)"
  extends Bases.Guide;
  extends Bases.DryFriction;
  parameter Real delta(unit = "1", min = 1, max = 4) = 2 "Exponent of the Stribeck curve: 2 Gauss, 1 Tustin";
  parameter Real peak(unit = "1", min = 1, max = 10) = 1 "Holding torque over tau_s";
  SI.AngularAcceleration a "Angular acceleration";
equation
  assert(peak >= 1, "peak must be at least 1");
  a = der(w);
  w_slide = w;
  a_slide = a;
  free = false;
  tau_0 = tau_s;
  tau_hold = peak*tau_s;
  tau_dry = tau_c + (tau_s - tau_c)*exp(-(noEvent(abs(w))/w_s)^delta);
  tau_visc = d*w;
  tau = tau_fric;
  annotation(Documentation(info = "<html>
<p>The law of <code>Friction</code> between a shaft and the housing. Interchangeable with <code>SmoothBearingFriction</code> and <code>LuGreBearingFriction</code>.</p></html>"));
end BearingFriction;
