within Mechanical.Translational.Bases;
partial model Compliant "Two flanges joined without inertia: force over relative position"
  Interfaces.TranslationalFlange flange_a "Flange a";
  Interfaces.TranslationalFlange flange_b "Flange b";
  SI.Position s_rel(nominal = 1e-2, start = 0) "Position of b relative to a";
  SI.Force f(nominal = 100, start = 0) "Force between the flanges, positive when it pulls b towards a";
equation
  s_rel = flange_b.s - flange_a.s;
  flange_b.f = f;
  flange_a.f = -f;
end Compliant;
