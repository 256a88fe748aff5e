within Hydraulic;
model Valve43FlowForce "4/3 valve operated directly: solenoid, springs, mass of the spool and flow forces"
  Interfaces.HydraulicPort port_P "Supply";
  Interfaces.HydraulicPort port_T "Return";
  Interfaces.HydraulicPort port_A "Consumer A";
  Interfaces.HydraulicPort port_B "Consumer B";
  Interfaces.RealInput u(unit = "1") "Command, -1 to 1; positive joins P to A and B to T";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 5e-4 "Flow through one edge when open, at dp_nom";
  parameter SI.Pressure dp_nom(min = 1e3, nominal = 1e6) = 5e5 "Pressure drop of q_nom at one edge";
  parameter Real overlap(unit = "1", min = -0.5, max = 0.5) = 0.1 "Travel before an edge opens";
  parameter Real rounding(unit = "1", min = 1e-4, max = 0.5) = 0.02 "Travel over which an edge opens smoothly";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-4 "Leakage cross section of an edge over its greatest";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter SI.Length x_max(min = 1e-5, max = 0.1, nominal = 1e-3) = 2e-3 "Travel of the spool to each side";
  parameter SI.Mass m(min = 1e-5, max = 100, nominal = 0.1) = 0.05 "Mass of spool and armature";
  parameter SI.Force F_max(min = 0.1, max = 1e4, nominal = 50) = 60 "Force of the solenoid at full command";
  parameter SI.TranslationalSpringConstant c(min = 1, max = 1e7, nominal = 1e4) = 3e4 "Centring springs";
  parameter SI.TranslationalDampingConstant d(min = 0, max = 1e5, nominal = 10) = 25 "Damping";
  parameter SI.Time tau(min = 1e-6, max = 1, nominal = 1e-2) = 10e-3 "Time constant of the solenoid's force";
  parameter SI.Angle theta(min = 0.1, max = 1.57) = 1.204 "Angle of the jet to the axis, 69 degrees";
  SpoolEdge edge_PA(A_max = A_max, overlap = overlap, rounding = rounding, leak = leak, C_d = C_d) "P to A";
  SpoolEdge edge_PB(A_max = A_max, overlap = overlap, rounding = rounding, leak = leak, C_d = C_d) "P to B";
  SpoolEdge edge_AT(A_max = A_max, overlap = overlap, rounding = rounding, leak = leak, C_d = C_d) "A to T";
  SpoolEdge edge_BT(A_max = A_max, overlap = overlap, rounding = rounding, leak = leak, C_d = C_d) "B to T";
  Mechanical.Translational.EndStops stops(s_min = -x_max, s_max = x_max, d_0 = min(1e-4, 1e-3*x_max)) "Ends of the travel";
  Mechanical.Translational.Mass spool(m = m) "Spool";
  Mechanical.Translational.SpringDamper spring(c = c, d = d) "Springs";
  Mechanical.Translational.Fixed housing "Housing";
  Mechanical.Translational.Force solenoid "Solenoid less flow force";
  SI.Force F(start = 0, fixed = true, nominal = 10) "Force of the solenoid";
  SI.Force F_flow(nominal = 10) "Flow force, closes the valve";
  Real x(unit = "1") "Position over x_max";
protected
  parameter SI.Area A_max = q_nom/(C_d*sqrt(2*dp_nom/oil.rho_0)) "Cross section of an open edge";
equation
  assert(q_nom > 0 and dp_nom > 0 and x_max > 0, "q_nom, dp_nom and x_max must be positive");
  x = spool.s/x_max;
  edge_PA.x = x;
  edge_BT.x = x;
  edge_PB.x = -x;
  edge_AT.x = -x;
  tau*der(F) = F_max*min(max(u, -1), 1) - F;
  F_flow = 2*C_d*cos(theta)*A_max*(
    Smooth.ramp(x - overlap, rounding)*(Smooth.mag(edge_PA.dp, 1e4) + Smooth.mag(edge_BT.dp, 1e4))
    - Smooth.ramp(-x - overlap, rounding)*(Smooth.mag(edge_PB.dp, 1e4) + Smooth.mag(edge_AT.dp, 1e4)))/(1 - overlap);
  solenoid.f = F - F_flow;
  connect(solenoid.flange, spool.flange_a);
  connect(stops.flange, spool.flange_a);
  connect(spool.flange_b, spring.flange_b);
  connect(spring.flange_a, housing.flange);
  connect(port_P, edge_PA.port_a);
  connect(edge_PA.port_b, port_A);
  connect(port_P, edge_PB.port_a);
  connect(edge_PB.port_b, port_B);
  connect(port_A, edge_AT.port_a);
  connect(edge_AT.port_b, port_T);
  connect(port_B, edge_BT.port_a);
  connect(edge_BT.port_b, port_T);
  annotation(Documentation(info = "<html>
<p><code>m x'' = F - F_flow - c x - d x'</code> with the steady flow force <code>F_flow = 2 C_d cos(theta) A |dp|</code> of every edge, which closes the valve: under high pressure it opens less than commanded, the limit of power of directly operated valves. Transient flow forces are left out.</p>
<p>Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 5.6.</p></html>"));
end Valve43FlowForce;
