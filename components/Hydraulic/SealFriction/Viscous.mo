within Hydraulic.SealFriction;
model Viscous "Viscous friction only"
  extends Law;
  parameter SI.TranslationalDampingConstant B(min = 0, max = 1e8, nominal = 1e3) = 2000 "Damping";
equation
  assert(B >= 0, "The damping B must not be negative");
  f = B*der(flange.s);
  annotation(Documentation(info = "<html><p><code>f = B v</code>: the naive form, without sticking.</p></html>"));
end Viscous;
