within Hydraulic.Spool;
block FirstOrder "Lag of first order"
  extends Law;
  parameter SI.Time tau(min = 1e-6, max = 10, nominal = 1e-2) = 0.02 "Time constant";
initial equation
  y = 0;
equation
  assert(tau > 0, "The time constant tau must be positive");
  tau*der(y) = min(max(u, -1), 1) - y;
  annotation(Documentation(info = "<html><p><code>tau dy/dt + y = u</code>, u limited to -1 to 1. For valves without a measured position, up to some <code>1/tau</code>. Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1: Hydraulik, 2012, switching valves.</p></html>"));
end FirstOrder;
