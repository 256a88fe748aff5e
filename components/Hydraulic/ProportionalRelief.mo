within Hydraulic;
model ProportionalRelief "Relief valve whose setting follows a signal"
  extends Bases.TwoPort;
  Interfaces.RealInput u "Command";
  parameter Real k_u(min = 0) = 1e6 "Pressure setting per unit of the command";
  parameter Real u_0 = 0 "Command at which the setting begins";
  parameter Real R_ov(unit = "Pa.s/m3", min = 1, nominal = 1e9) = 1e9 "Rise of pressure per flow";
  parameter SI.Time tau(min = 1e-5, max = 10, nominal = 1e-2) = 50e-3 "Time constant of the setting";
  parameter SI.Pressure w(min = 1, max = 1e6, nominal = 1e4) = 2e4 "Width of the opening";
  parameter Boolean hysteretic = false "true: the magnet follows the command with play" annotation(Evaluate = true);
  parameter Real h(min = 0) = 0.3 "Play, in the unit of the command; 3 % of the range is usual";
  parameter SI.Time tau_h(min = 1e-6, max = 1) = 1e-3 "Time in which the play follows";
  parameter Boolean steady = false "true: the setting has reached its command at the start" annotation(Evaluate = true);
  Real u_m "Command behind the play";
  SI.Pressure p_set(start = 0, fixed = not steady, nominal = 1e6) "Setting";
initial equation
  if hysteretic then
    u_m = u;
  end if;
  if steady then
    der(p_set) = 0;
  end if;
equation
  assert(h >= 0, "The play h must not be negative");
  if hysteretic then
    tau_h*der(u_m) = max(u - h/2 - u_m, 0) + min(u + h/2 - u_m, 0);
  else
    u_m = u;
  end if;
  assert(R_ov > 0 and tau > 0, "R_ov and tau must be positive");
  tau*der(p_set) = k_u*max(u_m - u_0, 0) - p_set;
  q = Smooth.pos(dp - p_set, w)/R_ov*Smooth.step(dp/w);
  annotation(Documentation(info = "<html><p><code>p = k_u (u - u_0) + R_ov q</code>, the setting behind a lag; a check in the direction of flow keeps it passive. With <code>hysteretic</code> the magnet sticks: u_m follows the command only beyond half the play to either side. Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1, 2012, proportional pressure valves.</p></html>"));
end ProportionalRelief;
