within Mechanical.Rotational;
model Differential "Bevel differential with final drive, without loss"
  Interfaces.RotationalFlange flange_a "Driving shaft";
  Interfaces.RotationalFlange left "Left half shaft";
  Interfaces.RotationalFlange right "Right half shaft";
  parameter Real ratio(unit = "1", min = 0.1, max = 100, nominal = 3) = 3 "Ratio of the final drive: speed of the driving shaft over mean speed of the half shafts";
  IdealGear drive(final ratio = ratio) "Final drive";
  IdealPlanetary bevel(final ratio = 1) "Bevel gears: both side gears have the same number of teeth";
equation
  assert(ratio > 0, "The ratio of the final drive must be positive");
  connect(flange_a, drive.flange_a);
  connect(drive.flange_b, bevel.carrier);
  connect(bevel.sun, left);
  connect(bevel.ring, right);
  annotation(Documentation(info = "<html><p><code>w_a = ratio (w_left + w_right)/2</code>; both half shafts get the same torque <code>ratio tau_a/2</code>, whatever their speeds: the wheel with less grip sets the pull of both. No losses, no lock; for a limited slip join <code>Friction</code> or <code>Clutch</code> between the half shafts.</p>
<p>Source: H. W. Mueller, Epicyclic Drive Trains, 1982, chapter 2: a planetary gear whose ratio is 1.</p></html>"));
end Differential;
