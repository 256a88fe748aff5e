within Hydraulic;
model AirVolume "Volume whose air dissolves and comes out of solution with time"
  extends Volume(
    redeclare model Air = EntrainedAir.Dissolving(x_start = x_start, p_sat = p_sat, tau_d = tau_d, tau_r = tau_r));
  parameter Real x_start(unit = "1", min = 0, max = 1) = oil.x_u "Undissolved share of the air at the start";
  parameter SI.Pressure p_sat(min = 1e5, max = 1e8, nominal = 1e6) = 3e6 "Pressure at which all air is dissolved in equilibrium";
  parameter SI.Time tau_d(min = 1e-3, max = 1e4, nominal = 10) = 10 "Time constant of dissolving, 1 to 60 s";
  parameter SI.Time tau_r(min = 1e-3, max = 1e4, nominal = 1) = 0.5 "Time constant of release";
  Real x(unit = "1") = air.x "Undissolved share of the air";
  Real x_eq(unit = "1") = 1 - Smooth.step((p - oil.p_0)/(p_sat - oil.p_0)) "Share in equilibrium";
  annotation(Documentation(info = "<html>
<p><code>Volume</code> with <code>EntrainedAir.Dissolving</code>, which says what holds in it; the same law goes into any chamber, line or cylinder by <code>redeclare model Air</code>.</p>
<p>Source: J. Ruan and R. Burton, IMECE2006-15854; J. Zhou, A. Vacca, B. Manhartsgruber, J. Fluids Eng. 135 (2013) 061101 for the finite rates. The time constants are assumed.</p></html>"));
end AirVolume;
