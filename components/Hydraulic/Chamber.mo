within Hydraulic;
model Chamber "Chamber of a cylinder: oil behind a moving piston"
  extends Bases.Storage(stored(nominal = oil.rho_0*V_0));
  Interfaces.TranslationalFlange flange "Piston; moving it in the positive direction enlarges the chamber where side is 1";
  parameter SI.Area A(min = 1e-8, max = 10, nominal = 1e-3, displayUnit = "cm2") = 1e-3 "Area of the piston";
  parameter Integer side(min = -1, max = 1) = 1 "1: enlarges with positive motion, -1: shrinks";
  parameter SI.Volume V_0(min = 1e-9, max = 10, nominal = 1e-4, displayUnit = "ml") = 1e-4 "Volume at s = s_0, with all that is joined rigidly";
  parameter SI.Position s_0 = 0 "Position of V_0";
  parameter SI.Volume V_min(min = 1e-12, nominal = 1e-6) = 1e-6 "Volume below which the piston leaves more and more oil behind";
  parameter SI.Pressure p_ambient(nominal = 1e5) = 101325 "Pressure on the other side of the piston, absolute";
  parameter SI.Pressure p_start(nominal = 1e6) = 101325 "Pressure at the start";
  SI.Pressure p(start = p_start, nominal = 1e6, stateSelect = StateSelect.prefer) "Pressure";
  SI.Volume V(nominal = 1e-4) "Volume";
protected
  Real share(unit = "1") "Change of V_oil over that of V";
  SI.Velocity v(nominal = 0.1) "Velocity of the piston";
equation
  assert(A > 0, "The area A must be positive");
  assert(side == 1 or side == -1, "side must be 1 or -1");
  assert(V > 0, "The piston has passed the end of the chamber: the volume is negative");
  assert(p > oil.p_void, "The oil cavitates: more is drawn than flows in, and voids open in the oil. Is a check valve or a charge pump missing?", AssertionLevel.warning);
  assert(p < oil.p_max, "The pressure exceeds p_max of the oil: more flows in than can leave. Is a relief valve missing, set too high, or joined the wrong way round?", AssertionLevel.warning);
  p = port.p;
  v = der(flange.s);
  V = V_0 + side*A*(flange.s - s_0);
  share = exp(min(V/V_min - 1, 0));
  V_oil = max(V, V_min)*share;
  V_oil/air.beta*der(p) = inflow - side*A*share*v;
  flange.f = -side*A*share*(p - p_ambient);
  annotation(Documentation(info = "<html><p><code>V/beta dp/dt = q - A v</code>, force <code>A (p - p_ambient)</code>. Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 6.1. Below <code>V_min</code> the oil keeps the volume <code>V_min exp(V/V_min - 1)</code>, which never ends; the oil has one pressure throughout, so no waves. The air in the oil is frozen; <code>redeclare model Air = EntrainedAir.Dissolving</code> lets it dissolve and come out of solution with time.</p></html>"));
end Chamber;
