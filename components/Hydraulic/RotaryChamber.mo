within Hydraulic;
model RotaryChamber "Chamber of a rotary actuator: oil behind a turning vane"
  extends Bases.Storage(stored(nominal = oil.rho_0*V_0));
  Interfaces.RotationalFlange flange "Shaft; turning it in the positive direction enlarges the chamber where side is 1";
  parameter Real D(unit = "m3/rad", min = 1e-9, max = 1, nominal = 1e-4) = 1e-4 "Volume displaced per radian";
  parameter Integer side(min = -1, max = 1) = 1 "1: enlarges with positive rotation, -1: shrinks";
  parameter SI.Volume V_0(min = 1e-9, max = 10, nominal = 1e-4, displayUnit = "ml") = 1e-4 "Volume at phi = phi_0, with all that is joined rigidly";
  parameter SI.Angle phi_0(min = -100, max = 100, nominal = 1, displayUnit = "deg") = 0 "Angle of V_0";
  parameter SI.Volume V_min(min = 1e-12, max = 1, nominal = 1e-6) = 1e-6 "Volume below which the vane leaves more and more oil behind";
  parameter SI.Pressure p_ambient(min = 0, max = 1e7, nominal = 1e5) = 101325 "Pressure from which the torque counts, absolute";
  parameter SI.Pressure p_start(min = 1e3, max = 1e8, nominal = 1e6) = 101325 "Pressure at the start";
  SI.Pressure p(start = p_start, nominal = 1e6, stateSelect = StateSelect.prefer) "Pressure";
  SI.Volume V(nominal = 1e-4) "Volume";
protected
  Real share(unit = "1") "Change of V_oil over that of V";
  SI.AngularVelocity w(nominal = 1) "Speed of the shaft";
equation
  assert(D > 0, "The volume per radian D must be positive");
  assert(side == 1 or side == -1, "side must be 1 or -1");
  assert(V > 0, "The vane has passed the end of the chamber: the volume is negative");
  assert(p > oil.p_void, "The oil cavitates: more is drawn than flows in, and voids open in the oil. Is a check valve or a charge pump missing?", AssertionLevel.warning);
  p = port.p;
  w = der(flange.phi);
  V = V_0 + side*D*(flange.phi - phi_0);
  share = exp(min(V/V_min - 1, 0));
  V_oil = max(V, V_min)*share;
  V_oil/air.beta*der(p) = inflow - side*D*share*w;
  flange.tau = -side*D*share*(p - p_ambient);
  annotation(Documentation(info = "<html><p><code>V/beta dp/dt = q - D w</code>, torque <code>D (p - p_ambient)</code>: <code>Chamber</code> with angle and torque. Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 6.1, with the displacement per radian instead of the area. Below <code>V_min</code> the oil keeps the volume <code>V_min exp(V/V_min - 1)</code>, which never ends; the oil has one pressure throughout, so no waves.</p></html>"));
end RotaryChamber;
