within Mechanical.Rotational;
model Crank "Slider crank, rotation to translation, exact and without loss"
  Interfaces.RotationalFlange flangeR "Shaft of the crank";
  Interfaces.TranslationalFlange flangeT "Slider; positive away from the shaft";
  parameter SI.Radius r(min = 1e-4, max = 100, nominal = 0.1) = 0.05 "Radius of the crank";
  parameter SI.Length l(min = 1e-4, max = 1e3, nominal = 0.1) = 0.2 "Length of the connecting rod";
  parameter SI.Distance e(min = -100, max = 100, nominal = 0.01) = 0 "Offset of the path of the slider from the axis of the shaft, positive to the side of angle pi/2";
  parameter SI.Position s_0 = 0 "Position of flangeT with the pin of the slider on the axis of the shaft";
  SI.Angle phi(displayUnit = "deg") "Angle of the crank; 0 points to the slider";
  Real i(unit = "m", nominal = 0.1) "Way of the slider over the angle";
protected
  SI.Distance y "Distance of the pin of the crank from the path of the slider";
  SI.Distance x "Length of the rod along the path of the slider";
equation
  assert(r > 0 and l > r + abs(e), "The rod is too short to go round: l must be above r + |e|");
  phi = flangeR.phi;
  y = r*sin(phi) - e;
  x = sqrt(l^2 - y^2);
  i = -r*sin(phi) - r*cos(phi)*y/x;
  flangeT.s = s_0 + r*cos(phi) + x;
  flangeR.tau = -i*flangeT.f;
  annotation(Documentation(info = "<html><p><code>s = r cos(phi) + sqrt(l^2 - (r sin(phi) - e)^2)</code>, <code>tau = -f ds/dphi</code>: presses, piston pumps. Rod without mass. At the dead centres the slider does not move with the crank, so that the shaft carries the motion: there must be an <code>Inertia</code> or a given speed on it, and a mass on the slider must leave the state to the shaft, <code>Mass slider(s(stateSelect = StateSelect.avoid), v(stateSelect = StateSelect.avoid))</code>.</p>
<p>Source: H. Dresig and F. Holzweissig, Dynamics of Machinery, 2010, section 2.4.</p></html>"));
end Crank;
