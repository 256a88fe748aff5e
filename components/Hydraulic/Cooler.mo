within Hydraulic;
model Cooler "Cooler: laminar resistance, and heat passed from the oil to air"
  extends Bases.HeatExchanger;
  parameter SI.Temperature T_ambient(min = 220, max = 420) = 293.15 "Temperature of the air";
  parameter Boolean useInput = false "true: a fan whose speed is u" annotation(Evaluate = true);
  parameter Real n_u(unit = "1", min = 0, max = 1) = 0.7 "kA grows with this power of the fan's speed";
  Interfaces.RealInput u(unit = "1") if useInput "Speed of the fan over the one of kA";
  Interfaces.HeatPort oilHeat if not oil.thermal "Thermal mass of the oil, where it has one temperature";
protected
  Interfaces.RealInput u_used(unit = "1") "Speed of the fan";
  SI.ThermalConductance kA_used(nominal = 100) "Heat transfer at that speed";
equation
  connect(u, u_used);
  if not useInput then
    u_used = 1;
  end if;
  kA_used = if useInput then kA*max(u_used, 1e-6)^n_u else kA;
  T_coolant = T_ambient;
  effectiveness = if oil.thermal then 1 - exp(-kA_used/C_oil) else 0;
  if not oil.thermal then
    oilHeat.Q_flow = kA_used*(oilHeat.T - T_ambient);
    Q_flow = oilHeat.Q_flow;
  end if;
  annotation(Documentation(info = "<html>
<p><b>Oil that carries heat</b> is cooled on its way: <code>T_out = T_air + (T_in - T_air) exp(-kA/(m c_p))</code>, air being plentiful. Where the oil has one temperature for the whole circuit, <code>kA (T_oil - T_air)</code> leaves what is joined to <code>oilHeat</code>, whatever the flow.</p>
<p>With <code>useInput</code> kA follows the speed of a fan, <code>kA u^n_u</code>. Source: Newton's law of cooling; the power 0.6 to 0.8 of the speed is that of turbulent air, VDI Heat Atlas, section G.</p></html>"));
end Cooler;
