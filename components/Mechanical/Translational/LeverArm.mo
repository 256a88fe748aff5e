within Mechanical.Translational;
model LeverArm "Arm on a shaft that moves a rod or slider, without loss"
  Interfaces.RotationalFlange flangeR "Shaft";
  Interfaces.TranslationalFlange flangeT "Rod";
  parameter SI.Length l(min = 1e-4, max = 1e3, nominal = 0.1) = 0.1 "Length of the arm";
  parameter Boolean exact = true "true: the rod moves by the sine of the angle, false: by the angle" annotation(Evaluate = true);
equation
  assert(l > 0, "The length l of the arm must be positive");
  if exact then
    assert(abs(flangeR.phi) < 1.56, "The arm lies in line with the rod and cannot move it");
    flangeT.s = l*sin(flangeR.phi);
    flangeR.tau = -l*cos(flangeR.phi)*flangeT.f;
  else
    flangeT.s = l*flangeR.phi;
    flangeR.tau = -l*flangeT.f;
  end if;
  annotation(Documentation(info = "<html><p>Exact: <code>s = l sin(phi)</code>, <code>tau = -l cos(phi) f</code>, the rod at right angles to the arm where the angle is 0 and staying parallel to itself (long rod). For small angles: <code>s = l phi</code>, within 1 % up to 14 degrees. A pedal, a valve lever, a swash plate on its piston.</p></html>"));
end LeverArm;
