within Mechanical.Rotational;
model LossyPlanetary "Planetary gear with efficiencies of its meshes that hold for all directions of power"
  Interfaces.RotationalFlange sun "Sun";
  Interfaces.RotationalFlange carrier "Carrier of the planets";
  Interfaces.RotationalFlange ring "Ring";
  parameter Real ratio(unit = "1", min = 1, max = 1e3, nominal = 2) = 2 "Teeth of the ring over teeth of the sun; 1: bevel gear";
  parameter Real eta_sun(unit = "1", min = 0.1, max = 1) = 0.98 "Efficiency of the mesh of sun and planets, carrier at rest";
  parameter Real eta_ring(unit = "1", min = 0.1, max = 1) = 0.99 "Efficiency of the mesh of planets and ring, carrier at rest";
  parameter SI.Power P_0(min = 1e-3, max = 1e6, nominal = 1) = 1 "Power over which the direction changes smoothly";
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the losses";
  SI.AngularVelocity w_rel(nominal = 10) "Speed of the sun against the carrier";
  SI.Power lossPower(nominal = 10) "Power lost";
protected
  parameter Real eta(unit = "1") = eta_sun*eta_ring "Efficiency from sun to ring, carrier at rest";
  SI.Power power(nominal = 100) "Power that rolls through the meshes, positive from sun to ring";
  Real side(unit = "1") "1: the sun drives, -1: the ring drives, as seen from the carrier";
  Real eta_sr(unit = "1") "Torque of the ring over ideal torque";
equation
  assert(ratio >= 1, "The ratio of a planetary gear, teeth of the ring over teeth of the sun, must be at least 1");
  assert(eta_sun > 0 and eta_sun <= 1 and eta_ring > 0 and eta_ring <= 1, "The efficiencies eta_sun and eta_ring must lie above 0 and not above 1");
  (1 + ratio)*carrier.phi = sun.phi + ratio*ring.phi;
  w_rel = der(sun.phi) - der(carrier.phi);
  power = w_rel*sun.tau;
  side = Smooth.sgn(power, P_0);
  eta_sr = 1 - (1 - eta)*noEvent(max(side, 0)) - (1/eta - 1)*noEvent(min(side, 0));
  ring.tau = ratio*eta_sr*sun.tau;
  sun.tau + carrier.tau + ring.tau = 0;
  lossPower = power*(1 - eta_sr);
  annotation(Documentation(info = "<html><p>Speeds as of <code>IdealPlanetary</code>. Losses arise where teeth roll on each other, by the power <code>tau_sun (w_sun - w_carrier)</code> seen from the carrier: <code>tau_ring = ratio eta tau_sun</code> where the sun drives, <code>ratio/eta tau_sun</code> where the ring does, with <code>eta = eta_sun eta_ring</code>. Turning as one block, the gear loses nothing. Around zero power the loss sets in over <code>P_0</code>; it is negative nowhere. Valid in motion: at rest nothing holds. No losses of bearings and oil: join <code>BearingFriction</code>.</p>
<p>Source: H. W. Mueller, Epicyclic Drive Trains, 1982, chapter 3; C. Pelchen, C. Schweiger, M. Otter, Modelica Conference 2002.</p></html>"));
end LossyPlanetary;
