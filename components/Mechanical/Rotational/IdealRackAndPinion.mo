within Mechanical.Rotational;
model IdealRackAndPinion "Turns rotation into translation: rack and pinion, belt, wheel or screw without loss"
  Interfaces.RotationalFlange flangeR "Shaft";
  Interfaces.TranslationalFlange flangeT "Rack";
  parameter Real ratio(unit = "rad/m") = 100 "Angle of the shaft over the way of the rack";
equation
  assert(abs(ratio) > 0, "The ratio must not be zero");
  flangeR.phi = ratio*flangeT.s;
  ratio*flangeR.tau + flangeT.f = 0;
  annotation(Documentation(info = "<html><p><code>phi = ratio s</code> without loss; <code>ratio</code> is one over the radius of the pinion.</p></html>"));
end IdealRackAndPinion;
