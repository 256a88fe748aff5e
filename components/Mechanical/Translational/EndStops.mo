within Mechanical.Translational;
model EndStops "End stops against the housing on both sides, elastic and damped, without sticking"
  Interfaces.TranslationalFlange flange "Flange";
  parameter SI.Position s_min = 0 "Lower stop";
  parameter SI.Position s_max = 1 "Upper stop";
  parameter SI.TranslationalSpringConstant k(min = 1e-3, max = 1e12, nominal = 1e8) = 1e8 "Stiffness";
  parameter Real c(unit = "N.s/m2", min = 0, max = 1e14, nominal = 1e9) = k*c_k "Damping per depth of penetration";
  parameter Real c_k(unit = "s/m", min = 0, max = 1e6, nominal = 10) = 10 "The same over the stiffness: it sets the bounce, whatever k";
  parameter SI.Distance d_0(min = 1e-9, max = 1e-2, nominal = 1e-4) = 1e-4 "Depth over which the contact sets in smoothly";
  SI.Velocity v(nominal = 0.1) "Velocity";
  SI.Force f(nominal = 100) "Force of the stops on the flange";
protected
  SI.Position low "Depth in the lower stop";
  SI.Position high "Depth in the upper stop";
equation
  assert(s_max > s_min, "The upper stop s_max must lie above the lower one s_min");
  assert(k > 0 and c >= 0, "The stiffness k must be positive, the damping c not negative");
  v = der(flange.s);
  low = max(s_min - flange.s, 0);
  high = max(flange.s - s_max, 0);
  f = Smooth.step(low/d_0)*low*(k + c*max(-v, 0)) - Smooth.step(high/d_0)*high*(k + c*max(v, 0));
  flange.f = -f;
  annotation(Documentation(info = "<html><p><code>S(d/d_0) d (k + c v_in)</code> with the depth d and the speed inward v_in; the damping acts only while the stop is compressed, so that it never pulls. It takes energy or stores it, nowhere gives.
With damping in proportion to the stiffness the rebound does not depend on k: it leaves with <code>1 - 2/3 c/k v</code> of a slow speed v of impact. Source: K. H. Hunt and F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440.</p></html>"));
end EndStops;
