within Hydraulic;
model RelativePressureSensor "Pressure of one node above another"
  Interfaces.HydraulicPort port_a "First node";
  Interfaces.HydraulicPort port_b "Second node";
  Interfaces.RealOutput dp(unit = "Pa", nominal = 1e6) "Pressure of a above b";
equation
  dp = port_a.p - port_b.p;
  port_a.q = 0;
  port_b.q = 0;
  annotation(Documentation(info = "<html><p><code>p = p_a - p_b</code>, without flow.</p></html>"));
end RelativePressureSensor;
