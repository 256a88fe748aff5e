within Hydraulic;
model PistonMachine "Axial piston machine, chamber by chamber: port timing, compression, bore leakage, ripple"
  Interfaces.HydraulicPort port_a(dT_outflow = if oil.thermal then T_oil - oil.T_0 else 0) "Port A: a pump that turns positively delivers here; oil that is fed in here turns a motor negatively";
  Interfaces.HydraulicPort port_b(dT_outflow = if oil.thermal then T_oil - oil.T_0 else 0) "Port B: a pump that turns positively draws here; oil that is fed in here turns a motor positively";
  Interfaces.HydraulicPort port_case(dT_outflow = if oil.thermal then T_oil - oil.T_0 else 0) "Case";
  Interfaces.RotationalFlange flange "Shaft";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter Integer z(min = 1, max = 15) = 7 "Number of pistons";
  parameter SI.Diameter d(min = 1e-3, max = 0.2, nominal = 1e-2) = 6.1e-3 "Diameter of the pistons";
  parameter SI.Length H(min = 1e-4, max = 1, nominal = 1e-2) = 4*0.8e-6/(7*Modelica.Constants.pi*6.1e-3^2) "Stroke at full displacement";
  parameter SI.Volume V_d(min = 1e-10, nominal = 1e-7) = 0.4*Modelica.Constants.pi*d^2/4*H "Dead volume of a chamber";
  parameter SI.Length h(min = 1e-7, max = 1e-3, nominal = 1e-5) = 7.5e-6 "Gap between piston and bore";
  parameter Real eps(unit = "1", min = 0, max = 1) = 0 "Eccentricity of the pistons";
  parameter SI.Length L(min = 1e-4, max = 1, nominal = 1e-2) = 15.2e-3 "Length of contact";
  parameter Boolean drag = false "true: with the oil dragged through the bore gap by the piston" annotation(Evaluate = true);
  parameter SI.Area A_port(min = 1e-9, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 22e-6 "Greatest cross section between chamber and kidney";
  parameter SI.Area A_leak(min = 1e-16, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section of a closed port";
  parameter SI.Angle opening(min = 1e-3, max = 0.5) = 3*Modelica.Constants.pi/180 "Angle over which a port opens";
  parameter SI.Angle timing_a(min = -0.5, max = 0.5) = 0 "Delay of port A against the dead centres";
  parameter SI.Angle timing_b(min = -0.5, max = 0.5) = 0 "Delay of port B against the dead centres";
  parameter SI.Area A_groove(min = 0, max = 1e-4, nominal = 1e-6, displayUnit = "mm2") = 0 "Cross section of a silencing groove where its port begins to open; 0: without grooves";
  parameter SI.Angle groove(min = 1e-3, max = 0.5) = 8*Modelica.Constants.pi/180 "Angle over which a groove widens, ahead of its port";
  parameter SI.Angle early(min = 0, max = 0.5) = 0 "Angle before the end of its half turn at which a port closes, to leave room for the groove of the other";
  parameter Boolean oneWay = false "true: ports let oil pass in the direction of pumping only, as check valves" annotation(Evaluate = true);
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter SI.Pressure t(min = 100, max = 1e6, nominal = 1e3) = 2e3 "Width of the laminar transition of the ports";
  parameter SI.Pressure p_start(nominal = 1e6) = 5e5 "Pressure of the chambers at the start";
  parameter SI.Torque T_c(min = 0, max = 1e3, nominal = 1) = 0 "Dry friction independent of pressure, smooth";
  parameter Real k_p(unit = "1", min = 0, max = 0.5) = 0 "Dry friction over the ideal torque";
  parameter SI.RotationalDampingConstant b(min = 0, max = 10, nominal = 1e-3) = 0 "Viscous friction";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 1) = 1 "Width of the sign of speed in the dry friction";
  parameter Boolean useInput = false "true: the displacement follows u, -1 to 1" annotation(Evaluate = true);
  Interfaces.RealInput u if useInput "Displacement over the greatest one";
  parameter SI.Volume V_oil(nominal = 1e-4, displayUnit = "ml") = 2*z*(V_d + H*Modelica.Constants.pi*d^2/4) "Oil in the machine that has its temperature, where oil carries heat";
  parameter SI.Temperature T_oil_start(min = 220, max = 420) = oil.T_0 "Temperature of that oil at the start";
  parameter Boolean useHeatPort = false "true: losses heat what is joined to heatPort; where oil carries heat, the oil exchanges it there" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = Q_heat) if useHeatPort "Case: heat of the losses";
  SI.AngularVelocity w(nominal = 100) "Speed of the shaft";
  SI.Pressure dp(nominal = 1e6) "Pressure of A above B";
  SI.VolumeFlowRate Q_A(nominal = 1e-4) "Volume flow out of port A";
  SI.Pressure p[z](each start = p_start, each nominal = 1e6) "Pressures of the chambers";
  SI.Volume V[z](each nominal = 1e-7) "Volumes of the chambers";
  SI.VolumeFlowRate q_a[z](each nominal = 1e-5) "Flows from the chambers to port A, at mean density";
  SI.VolumeFlowRate q_b[z](each nominal = 1e-5) "Flows from port B to the chambers, at mean density";
  SI.VolumeFlowRate q_l[z](each nominal = 1e-8) "Leakages of the chambers to the case";
  SI.Torque T_sh(nominal = 1) "Torque that the shaft gives to the machine";
  SI.Torque T_loss "Friction torque";
  SI.Mass mass(nominal = 1e-3) "Mass of the oil in the chambers";
  SI.Power lossPower(nominal = 10) "Power lost in ports, bores and by friction";
  SI.Temperature T_oil(start = T_oil_start, fixed = oil.thermal, nominal = 300) "Temperature of the oil in the machine";
protected
  constant Real pi = Modelica.Constants.pi;
  parameter SI.Area A_p = pi*d^2/4 "Area of a piston";
  parameter SI.Area A_drag = if drag then pi*d*h/2 else 0 "Area that the dragged oil adds to that of a piston: up to the middle of the gap";
  parameter Real s_o = sin(opening) "Sine of the opening angle";
  parameter Real s_g = sin(groove) "Sine of the angle of a groove";
  Interfaces.RealInput u_used "Displacement";
  SI.Angle phi[z] "Angles of the pistons, 0 at the outer dead centre";
  SI.Velocity v[z](each nominal = 0.1) "Velocities of the pistons inward";
  SI.Area A_a[z](each nominal = 1e-5) "Cross sections to port A";
  SI.Area A_b[z](each nominal = 1e-5) "Cross sections to port B";
  SI.Pressure dp_a[z](each nominal = 1e6) "Pressure drops to port A";
  SI.Pressure dp_b[z](each nominal = 1e6) "Pressure drops from port B";
  SI.Density rho[z](each nominal = 1000) "Densities of the chambers";
  SI.BulkModulus beta[z](each nominal = 1e9) "Moduli of the chambers";
  SI.HeatFlowRate Q_heat(nominal = 10) "Heat that comes in through heatPort";
  Real growth(unit = "1") "Volume of the oil over that at T_0";
  SI.DynamicViscosity mu_oil(nominal = 0.03) "Viscosity of the oil at low pressure";
  SI.Density rho_a(nominal = 1000) "Density at A, at T_0";
  SI.Density rho_b(nominal = 1000) "Density at B";
  SI.Density rho_c(nominal = 1000) "Density in the case";
equation
  assert(H > 0 and d > 0 and V_d > 0, "Stroke, diameter and dead volume must be positive");
  assert(h > 0 and A_port > 0, "Gap and port area must be positive");
  connect(u, u_used);
  if not useInput then
    u_used = 1;
  end if;
  w = der(flange.phi);
  dp = port_a.p - port_b.p;
  if oil.thermal then
    growth = oil.growth(T_oil);
    mu_oil = oil.viscosity(T_oil);
    oil.rho_0*V_oil*oil.c_p*der(T_oil) = rho_a*oil.c_p*(max(port_a.q, 0)*(inStream(port_a.dT_outflow) - port_a.dT_outflow) + port_a.q*oil.throttling(port_a.p))
      + rho_b*oil.c_p*(max(port_b.q, 0)*(inStream(port_b.dT_outflow) - port_b.dT_outflow) + port_b.q*oil.throttling(port_b.p))
      + rho_c*oil.c_p*(max(port_case.q, 0)*(inStream(port_case.dT_outflow) - port_case.dT_outflow) + port_case.q*oil.throttling(port_case.p)) + T_sh*w + Q_heat;
    if useHeatPort then
      heatPort.T = T_oil;
    else
      Q_heat = 0;
    end if;
  else
    growth = 1;
    mu_oil = oil.mu;
    T_oil = oil.T;
    Q_heat = if useHeatPort then -lossPower else 0;
  end if;
  rho_a = oil.density(port_a.p);
  rho_b = oil.density(port_b.p);
  rho_c = oil.density(port_case.p);
  for i in 1:z loop
    phi[i] = flange.phi + 2*pi*i/z;
    V[i] = V_d + A_p*(H/2)*(1 + u_used*cos(phi[i]));
    v[i] = H/2*u_used*w*sin(phi[i]);
    (rho[i], beta[i]) = oil.density(p[i]);
    if A_groove > 0 or early > 0 then
      A_a[i] = A_leak + A_port*Smooth.step(sin(phi[i] - timing_a)/s_o)*Smooth.step(sin(phi[i] - timing_a + early)/s_o)
        + A_groove*Smooth.step(1 + sin(phi[i] - timing_a)/s_g)*Smooth.step(0.5 + cos(phi[i] - timing_a));
      A_b[i] = A_leak + A_port*Smooth.step(-sin(phi[i] - timing_b)/s_o)*Smooth.step(-sin(phi[i] - timing_b + early)/s_o)
        + A_groove*Smooth.step(1 - sin(phi[i] - timing_b)/s_g)*Smooth.step(0.5 - cos(phi[i] - timing_b));
    else
      A_a[i] = A_leak + A_port*Smooth.step(sin(phi[i] - timing_a)/s_o);
      A_b[i] = A_leak + A_port*Smooth.step(-sin(phi[i] - timing_b)/s_o);
    end if;
    dp_a[i] = if oneWay then Smooth.ramp(p[i] - port_a.p, t) else p[i] - port_a.p;
    dp_b[i] = if oneWay then Smooth.ramp(port_b.p - p[i], t) else port_b.p - p[i];
    q_a[i] = C_d*A_a[i]*sqrt(4/(rho[i] + rho_a))*Smooth.root(dp_a[i], t);
    q_b[i] = C_d*A_b[i]*sqrt(4/(rho[i] + rho_b))*Smooth.root(dp_b[i], t);
    q_l[i] = pi*d*h^3*(1 + 1.5*eps^2)/(12*oil.thickening(mu_oil, (p[i] + port_case.p)/2 - oil.p_0)*L)*(p[i] - port_case.p) - A_drag*v[i];
    rho[i]*V[i]/beta[i]*der(p[i]) = rho[i]*A_p*v[i] - (rho[i] + rho_c)/2*q_l[i] - (rho[i] + rho_a)/2*q_a[i] + (rho[i] + rho_b)/2*q_b[i];
  end for;
  rho_a*Q_A = sum((rho[i] + rho_a)/2*q_a[i] for i in 1:z)/(if oil.thermal then growth else 1);
  port_a.q = -Q_A;
  rho_b*port_b.q = sum((rho[i] + rho_b)/2*q_b[i] for i in 1:z)/(if oil.thermal then growth else 1);
  rho_c*port_case.q = -sum((rho[i] + rho_c)/2*q_l[i] for i in 1:z)/(if oil.thermal then growth else 1);
  T_loss = (T_c + k_p*z*A_p*H/(2*pi)*Smooth.mag(dp, 1e4))*Smooth.sgn(w, w_s) + b*w;
  T_sh = sum((p[i] - port_case.p)*(A_p + A_drag)*(H/2)*u_used*sin(phi[i]) for i in 1:z) + T_loss;
  flange.tau = T_sh;
  mass = sum(rho[i]*V[i] for i in 1:z)/(if oil.thermal then growth else 1);
  lossPower = sum(q_a[i]*(p[i] - port_a.p) + q_b[i]*(port_b.p - p[i]) + (q_l[i] + A_drag*v[i])*(p[i] - port_case.p) for i in 1:z) + T_loss*w;
  annotation(Documentation(info = "<html>
<p>Piston i at <code>phi_i = theta + 2 pi i/z</code>, chamber <code>V_d + A_p H/2 (1 + cos phi_i)</code>; <code>V_i/beta dp_i/dt = A_p v_i - q_leak - q_A + q_B</code> in masses. The ports open over the angle <code>opening</code> from the dead centres on, with flow in both directions,
so that compression, backflow at opening and the ripple of flow and torque come out of the equations: averaged, the loss per stroke is <code>(V_s + V_d) dp/beta</code>. The kinematic ripple for an odd number of pistons is <code>pi/(2 z) tan(pi/(4 z))</code> of the mean, peak to peak; 2.5 % for seven.</p>
<p><b>Silencing grooves</b> (<code>A_groove</code>) let a chamber meet its port <code>groove</code> before the edge of the kidney comes: at the ends where the ports begin to open in positive rotation, each opening from 0 over the angle. Let the ports close as much before (<code>early</code>), else the groove of one port meets the other one still open.</p>
<p><b>One-way ports</b> (<code>oneWay</code>) are the switch <code>p_i >= p_A</code> of the paper: no oil comes back, and the piston compresses by itself, as in a pump with check valves. The flow lacks what is compressed all the same, but what is lost at a port plate when oil rushes back is not. It pumps whichever way it turns where A is the high side, and cannot be a motor.</p>
<p>With <code>drag</code> a piston drags half of the oil in its gap along, and the pressure drop along the gap pulls at the piston: together the piston is as large as the middle of the gap, which neither loses nor gives energy. The shear of the film itself is in <code>b</code>.</p>
<p>The input <code>u</code> scales the stroke about its middle (variable displacement, over centre when negative); what the pistons move while the plate itself swings is left out. Very stiff: nanoseconds at open ports. Where oil carries heat, the machine has one temperature, and the oil in its chambers (a millilitre) does not give way as it warms. Inertia of the oil in the ports and squeeze of the films are left out too: valid up to some thousand revolutions per minute. Source: Zhang et al., Processes 2021, 9, 814, equations of section 4.2.2, with a port that lets oil back (<code>oneWay = false</code>) and with drag in the bore. Grooves: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001.</p></html>"));
end PistonMachine;
