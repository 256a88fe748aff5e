within Mechanical.Translational;
model Damper "Linear damper"
  extends Bases.Compliant;
  parameter SI.TranslationalDampingConstant d(min = 0, max = 1e10, nominal = 1e3) = 1e3 "Damping";
  SI.Velocity v_rel(nominal = 0.1) "Relative speed";
  SI.Power lossPower "Power lost";
equation
  assert(d >= 0, "The damping d must not be negative");
  v_rel = der(s_rel);
  f = d*v_rel;
  lossPower = f*v_rel;
  annotation(Documentation(info = "<html><p><code>f = d v_rel</code>; power is lost in it, never given.</p></html>"));
end Damper;
