within Mechanical.Rotational;
model Screw "Screw spindle with efficiency"
  Interfaces.RotationalFlange flangeR "Spindle";
  Interfaces.TranslationalFlange flangeT "Nut";
  parameter SI.Length pitch(min = 1e-6, max = 1, nominal = 1e-2) = 1e-2 "Way of the nut per revolution";
  parameter Real eta(unit = "1", min = 0.05, max = 1) = 0.9 "Efficiency when the spindle drives";
  parameter Real eta_back(unit = "1", min = 0, max = 1) = max(2 - 1/eta, 0) "Efficiency when the nut drives; 0 self-locking, which is what an efficiency up to a half means";
  parameter SI.Power P_0(min = 1e-3) = 1 "Power over which the direction changes smoothly";
  SI.Power lossPower "Power lost";
protected
  parameter Real lead(unit = "m/rad") = pitch/(2*Modelica.Constants.pi) "Way per radian";
  SI.Power power "Power out of the nut";
  Real side(unit = "1") "1: the spindle drives, -1: the nut drives";
  Real k(unit = "1") "Torque over ideal torque";
equation
  assert(pitch > 0, "The pitch must be positive");
  assert(eta > 0 and eta <= 1 and eta_back >= 0 and eta_back <= 1, "The efficiencies must lie from 0 to 1");
  flangeT.s = lead*flangeR.phi;
  power = -flangeT.f*der(flangeT.s);
  side = Smooth.sgn(power, P_0);
  k = 1 + (1/eta - 1)*noEvent(max(side, 0)) + (1 - eta_back)*noEvent(min(side, 0));
  flangeR.tau = -lead*k*flangeT.f;
  lossPower = (k - 1)*power;
  annotation(Documentation(info = "<html><p>Ideal where <code>eta = 1</code>. The efficiency of back driving follows for equal friction from that of driving, <code>2 - 1/eta</code>. Around zero power the loss sets in over <code>P_0</code>; it is negative nowhere. A self-locking screw is driven back without torque at the spindle, but nothing sticks: for a load that must hold add a <code>BearingFriction</code>. Source: G. Niemann, Maschinenelemente 1, 2005, screws for motion.</p></html>"));
end Screw;
