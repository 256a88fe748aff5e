within Hydraulic.Spool;
block Hysteretic "Lag of first order behind play (hysteresis)"
  extends Law;
  parameter Real h(unit = "1", min = 0, max = 0.5) = 0.03 "Width of the hysteresis";
  parameter SI.Time tau(min = 1e-6, max = 10, nominal = 1e-2) = 0.02 "Time constant";
  parameter SI.Time tau_h(min = 1e-6, max = 1) = 1e-3 "Time in which the play follows";
  Real z(unit = "1", start = 0, fixed = true) "Command behind the play";
initial equation
  y = 0;
equation
  assert(h >= 0 and tau > 0, "h must not be negative, tau must be positive");
  tau_h*der(z) = max(u - h/2 - z, 0) + min(u + h/2 - z, 0);
  tau*der(y) = min(max(z, -1), 1) - y;
  annotation(Documentation(info = "<html><p>Play of the width h (friction of the spool) before a lag: y follows only when the command has passed the play. Valid for play that does not depend on the rate. Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1: Hydraulik, 2012, proportional valves without measured position.</p></html>"));
end Hysteretic;
