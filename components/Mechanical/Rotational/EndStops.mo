within Mechanical.Rotational;
model EndStops "End stops against the housing on both sides, elastic and damped, without sticking"
  Interfaces.RotationalFlange flange "Flange";
  parameter SI.Angle phi_min = -1 "Lower stop";
  parameter SI.Angle phi_max = 1 "Upper stop";
  parameter SI.RotationalSpringConstant k(min = 1e-3, max = 1e12, nominal = 1e5) = 1e5 "Stiffness";
  parameter Real c(unit = "N.m.s/rad2", min = 0, max = 1e14, nominal = 1e5) = k*c_k "Damping per depth of penetration";
  parameter Real c_k(unit = "s/rad", min = 0, max = 1e6, nominal = 1) = 1 "The same over the stiffness: it sets the bounce, whatever k";
  parameter SI.Angle d_0(min = 1e-9, max = 1e-1, nominal = 1e-3) = 1e-3 "Depth over which the contact sets in smoothly";
  SI.AngularVelocity w(nominal = 10) "Speed";
  SI.Torque tau(nominal = 100) "Torque of the stops on the flange";
protected
  SI.Angle low "Depth in the lower stop";
  SI.Angle high "Depth in the upper stop";
equation
  assert(phi_max > phi_min, "The upper stop phi_max must lie above the lower one phi_min");
  assert(k > 0 and c >= 0, "The stiffness k must be positive, the damping c not negative");
  w = der(flange.phi);
  low = max(phi_min - flange.phi, 0);
  high = max(flange.phi - phi_max, 0);
  tau = Smooth.step(low/d_0)*low*(k + c*max(-w, 0)) - Smooth.step(high/d_0)*high*(k + c*max(w, 0));
  flange.tau = -tau;
  annotation(Documentation(info = "<html><p>Of a rotary actuator or a pedal: <code>S(d/d_0) d (k + c w_in)</code> with the depth d and the speed inward w_in; the damping acts only while the stop is compressed, so that it never pulls. It takes energy or stores it, nowhere gives.
With damping in proportion to the stiffness the rebound does not depend on k: it leaves with <code>1 - 2/3 c/k w</code> of a slow speed w of impact. Source: K. H. Hunt and F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440.</p></html>"));
end EndStops;
