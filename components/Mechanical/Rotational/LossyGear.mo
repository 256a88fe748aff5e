within Mechanical.Rotational;
model LossyGear "Gear with an efficiency that holds for both directions of power"
  Interfaces.RotationalFlange flange_a "Driving shaft";
  Interfaces.RotationalFlange flange_b "Driven shaft";
  parameter Real ratio(unit = "1") = 1 "Angle of a over angle of b";
  parameter Real eta(unit = "1", min = 0.01, max = 1) = 0.97 "Efficiency, power out over power in";
  parameter SI.Power P_0(min = 1e-3) = 1 "Power over which the direction changes smoothly";
  SI.AngularVelocity w(nominal = 10) "Speed of the driving shaft";
  SI.Power lossPower "Power lost";
protected
  SI.Power power "Power into flange a";
  Real side(unit = "1") "1: a drives, -1: b drives";
  Real eta_ab(unit = "1") "Torque of b over ideal torque";
equation
  assert(abs(ratio) > 0, "The ratio of the gear must not be zero");
  assert(eta > 0 and eta <= 1, "The efficiency eta must lie above 0 and not above 1");
  flange_a.phi = ratio*flange_b.phi;
  w = der(flange_a.phi);
  power = w*flange_a.tau;
  side = Smooth.sgn(power, P_0);
  eta_ab = 1 - (1 - eta)*noEvent(max(side, 0)) - (1/eta - 1)*noEvent(min(side, 0));
  flange_b.tau = -ratio*eta_ab*flange_a.tau;
  lossPower = power*(1 - eta_ab);
  annotation(Documentation(info = "<html><p>Torque at b is <code>eta</code> times the ideal one where a drives and <code>1/eta</code> times where b drives. Around zero power the loss sets in over <code>P_0</code>; it is negative nowhere. Valid in motion: at rest nothing holds, where real gears of low efficiency lock. Source: C. Pelchen, C. Schweiger, M. Otter, Modeling and simulating the efficiency of gearboxes, Modelica Conference 2002.</p></html>"));
end LossyGear;
