within Pneumatic;
model Silencer "Silencer at an exhaust: restriction to the atmosphere"
  PneumaticPort port "Port";
  parameter Real C(unit = "m3/(s.Pa)", min = 1e-14, max = 1e-5, nominal = 1e-8) = 2e-8 "Sonic conductance; 1e-8 m3/(s.Pa) is 1 dm3/(s.bar)";
  parameter Real b(unit = "1", min = 0, max = 0.8) = 0.3 "Critical pressure ratio";
  Orifice orifice(C = C, b = b) "Restriction";
  Atmosphere atmosphere "Surroundings";
equation
  connect(port, orifice.port_a);
  connect(orifice.port_b, atmosphere.port);
  annotation(Documentation(info = "<html><p>An <code>Orifice</code> that ends in the <code>Atmosphere</code>; it breathes in where the pressure at the port lies below that. Source: ISO 6358-1:2013.</p></html>"));
end Silencer;
