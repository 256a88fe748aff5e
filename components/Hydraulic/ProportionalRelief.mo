within Hydraulic;
model ProportionalRelief "Relief valve whose setting follows a signal"
  extends Bases.TwoPort;
  Interfaces.RealInput u "Command";
  parameter Real k_u(min = 0) = 1e6 "Pressure setting per unit of the command";
  parameter Real u_0 = 0 "Command at which the setting begins";
  parameter Real R_ov(unit = "Pa.s/m3", min = 1, nominal = 1e9) = 1e9 "Rise of pressure per flow";
  parameter SI.Time tau(min = 1e-5, max = 10, nominal = 1e-2) = 50e-3 "Time constant of the setting";
  parameter SI.Pressure w(min = 1, max = 1e6, nominal = 1e4) = 2e4 "Width of the opening";
  SI.Pressure p_set(start = 0, fixed = true, nominal = 1e6) "Setting";
equation
  assert(R_ov > 0 and tau > 0, "R_ov and tau must be positive");
  tau*der(p_set) = k_u*max(u - u_0, 0) - p_set;
  q = Smooth.pos(dp - p_set, w)/R_ov*Smooth.step(dp/w);
  annotation(Documentation(info = "<html><p><code>p = k_u (u - u_0) + R_ov q</code>, the setting behind a lag; a check in the direction of flow keeps it passive. Hysteresis of the magnet is left out.</p></html>"));
end ProportionalRelief;
