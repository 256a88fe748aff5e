within Hydraulic.EntrainedAir;
partial model Law "Density and modulus of the oil in a volume, with its air"
  outer Oil.Fluid oil "Oil of the circuit";
  input SI.Pressure p(nominal = 1e6) "Pressure in the volume" annotation(HideResult = true);
  input SI.Volume V(nominal = 1e-4) "Oil in the volume" annotation(HideResult = true);
  input SI.MassFlowRate supply(nominal = 0.1) "Oil that flows in, each flow by the share of its air above the one here" annotation(HideResult = true);
  Real x(unit = "1") "Undissolved share of the air" annotation(HideResult = true);
  SI.Density rho(nominal = 1000) "Density" annotation(HideResult = true);
  SI.Density rho_s(nominal = 1000) "Density by which the volume stores" annotation(HideResult = true);
  SI.Density rho_port(nominal = 1000) "Density by which it counts what flows through ports" annotation(HideResult = true);
  Real counted(unit = "1") "What it counts of a mass that flows in: 1 but for laws whose modulus does not belong to their density" annotation(HideResult = true);
  SI.BulkModulus beta(nominal = 1e9) "Tangent bulk modulus at constant share" annotation(HideResult = true);
  Real port_density(unit = "1") "Density of what flows through ports over the density here" annotation(HideResult = true);
  SI.VolumeFlowRate swell(nominal = 1e-6) "Rate at which air that comes out of solution takes volume" annotation(HideResult = true);
protected
  SI.Density s(nominal = 1000) "What the law says of that" annotation(HideResult = true);
equation
  rho_s = noEvent(if s > 0 then s else rho);
  counted = noEvent(if s > 0 then s/rho else 1);
  annotation(Documentation(info = "<html>
<p>Exchanged by <code>redeclare model Air</code> of <code>Volume</code>, <code>Chamber</code>, <code>Line</code>, <code>Hose</code> and the cylinders. A volume under pressure takes <code>V/beta dp/dt - swell</code> of oil; <code>supply</code> is the sum of <code>m_flow (x_in - x)</code> over what flows in.</p></html>"));
end Law;
