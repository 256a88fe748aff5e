within Hydraulic;
model CasePump "Displacement machine with leakage to the case: Pump and a gap from each port to the case"
  Interfaces.HydraulicPort port_a "Port A: a pump that turns positively delivers here; oil that is fed in here turns a motor negatively";
  Interfaces.HydraulicPort port_b "Port B: a pump that turns positively draws here; oil that is fed in here turns a motor positively";
  Interfaces.HydraulicPort port_case "Case";
  Interfaces.RotationalFlange flange "Shaft";
  parameter SI.Volume V(min = 1e-9, max = 1e-2, nominal = 1e-5, displayUnit = "ml") = 1e-5 "Displacement per revolution";
  parameter Real G_i(unit = "m3/(s.Pa)", min = 0, max = 1e-8, nominal = 1e-12) = 1e-13 "Conductance of the internal leakage at mu_G";
  parameter Real G_e(unit = "m3/(s.Pa)", min = 0, max = 1e-8, nominal = 1e-12) = 1e-13 "Conductance from each port to the case at mu_G";
  parameter SI.DynamicViscosity mu_G(min = 1e-4, max = 10, nominal = 0.03) = 0.04 "Viscosity at which the conductances hold";
  replaceable Pump machine constrainedby Bases.Machine(V = V, mu_G = mu_G) "Machine";
  LaminarGap gap_a(G = G_e, mu_G = mu_G) "Leakage from A to the case";
  LaminarGap gap_b(G = G_e, mu_G = mu_G) "Leakage from B to the case";
  LaminarGap gap_i(G = G_i, mu_G = mu_G) "Further leakage from A to B";
equation
  assert(G_i >= 0 and G_e >= 0, "Leakages must not be negative");
  connect(port_a, machine.port_a);
  connect(port_b, machine.port_b);
  connect(flange, machine.flange);
  connect(port_a, gap_a.port_a);
  connect(gap_a.port_b, port_case);
  connect(port_b, gap_b.port_a);
  connect(gap_b.port_b, port_case);
  connect(port_a, gap_i.port_a);
  connect(gap_i.port_b, port_b);
  annotation(Documentation(info = "<html><p>A machine (replaceable) with laminar gaps from each port to the case and between the ports, for circuits where it matters which way the leakage takes. Valid while the gaps stay laminar; the pressure in the case is that of <code>port_case</code>. Source: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001.</p></html>"));
end CasePump;
