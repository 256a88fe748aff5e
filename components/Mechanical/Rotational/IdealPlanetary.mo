within Mechanical.Rotational;
model IdealPlanetary "Planetary gear without loss: sun, carrier, ring"
  Interfaces.RotationalFlange sun "Sun";
  Interfaces.RotationalFlange carrier "Carrier of the planets";
  Interfaces.RotationalFlange ring "Ring";
  parameter Real ratio(unit = "1", min = 1, max = 1e3, nominal = 2) = 2 "Teeth of the ring over teeth of the sun; 1: bevel gear";
equation
  assert(ratio >= 1, "The ratio of a planetary gear, teeth of the ring over teeth of the sun, must be at least 1");
  (1 + ratio)*carrier.phi = sun.phi + ratio*ring.phi;
  ring.tau = ratio*sun.tau;
  carrier.tau = -(1 + ratio)*sun.tau;
  annotation(Documentation(info = "<html><p>Willis: <code>(1 + ratio) w_carrier = w_sun + ratio w_ring</code>; the torques are as <code>1 : ratio : -(1 + ratio)</code> at sun, ring and carrier, so that neither torque nor power is lost. The planets have no inertia. With losses: <code>LossyPlanetary</code>.</p>
<p>Source: R. Willis, Principles of Mechanism, 1841; H. W. Mueller, Epicyclic Drive Trains, 1982, chapter 2; IdealPlanetary of the Modelica Standard Library.</p></html>"));
end IdealPlanetary;
