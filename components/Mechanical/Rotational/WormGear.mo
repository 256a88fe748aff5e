within Mechanical.Rotational;
model WormGear "Worm gear: efficiency from lead angle and friction, self-locking where the lead angle is below the angle of friction"
  Interfaces.RotationalFlange flange_a "Worm";
  Interfaces.RotationalFlange flange_b "Wheel";
  parameter Real ratio(unit = "1") = 40 "Angle of the worm over angle of the wheel; negative: left-handed";
  parameter SI.Angle gamma(min = 0.01, max = 1.2, displayUnit = "deg") = 0.09 "Lead angle of the worm at its mean diameter";
  parameter Real mu(unit = "1", min = 0, max = 0.5) = 0.05 "Coefficient of friction of the flanks";
  parameter SI.Angle alpha(min = 0, max = 0.8, displayUnit = "deg") = 0.349 "Pressure angle, normal to the flank";
  parameter SI.AngularVelocity w_0(min = 1e-4, max = 10, nominal = 0.1) = 0.1 "Speed of the worm over which friction changes its sign";
  parameter SI.Torque tau_0(min = 1e-6, max = 1e4, nominal = 0.1) = 0.1 "Torque of the wheel over which friction sets in";
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the losses";
  SI.AngularVelocity w(nominal = 10) "Speed of the worm";
  SI.Torque tau_ideal(nominal = 10) "Torque at the worm without friction";
  SI.Power lossPower "Power lost";
protected
  parameter SI.Angle rho = atan(mu/cos(alpha)) "Angle of friction";
  Real side(unit = "1") "1: friction against the worm as driver, -1: as driven";
equation
  assert(abs(ratio) > 0, "The ratio of the gear must not be zero");
  assert(gamma > 0 and mu >= 0 and alpha >= 0 and alpha < 1.2, "The lead angle gamma must be positive, mu and alpha not negative, alpha below 1.2 rad");
  assert(gamma + rho < 1.5, "Lead angle and angle of friction together must lie below 1.5 rad: beyond, the worm cannot turn the wheel");
  assert(w_0 > 0 and tau_0 > 0, "w_0 and tau_0 must be positive");
  flange_a.phi = ratio*flange_b.phi;
  w = der(flange_a.phi);
  tau_ideal = -flange_b.tau/ratio;
  side = Smooth.sgn(w, w_0)*Smooth.sgn(ratio*tau_ideal, tau_0);
  flange_a.tau = tau_ideal*tan(gamma + rho*side)/tan(gamma);
  lossPower = w*(flange_a.tau - tau_ideal);
  annotation(Documentation(info = "<html><p><code>tau_a = tau_ideal tan(gamma + rho side)/tan(gamma)</code> with the angle of friction <code>rho = atan(mu/cos(alpha))</code>; <code>side</code> is the sign of the speed times that of the torque. So the efficiency is <code>tan(gamma)/tan(gamma + rho)</code> where the worm drives and <code>tan(gamma - rho)/tan(gamma)</code> where the wheel drives. With <code>gamma</code> below <code>rho</code> the latter is negative: the wheel turns the worm only if the worm is driven as well.</p>
<p>The sign of the speed is rounded over <code>w_0</code>: a self-locking gear under load does not stick but creeps, the worm at <code>w_0 artanh(gamma/rho)</code> where nothing else holds it. The loss is negative nowhere. Friction does not depend on speed; bearings and churning are left out: add a <code>BearingFriction</code>.</p>
<p>Where the wheel with a large inertia drives a self-locking worm, no acceleration may fulfil the equations (a real gear jams): valid while the inertia at the wheel over <code>ratio^2</code>, times <code>tan(rho - gamma)/tan(gamma)</code>, stays below that of the worm. Source: G. Niemann and H. Winter, Maschinenelemente 3, 1983, worm gears.</p></html>"));
end WormGear;
